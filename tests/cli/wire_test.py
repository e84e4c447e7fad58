"""VRPN on the command line: wii serve and wii listen, over the loopback interface, on ports that the system chooses."""
import csv
import json
import os
import re
import signal
import socket
import struct
import subprocess
import time
import unittest

from program import SHARED, VERISIM, ProgramTest
from wii_test import COLUMNS

COOKIE = b"vrpn: ver. 07.38  0".ljust(24, b"\0")
GOLDEN = os.path.join(SHARED, "..", "reference", "vrpn_wire", "golden.json")


def moving_trace(rows=60, leds=""):
    lines = ["# verisim-trace 1", "# kind: wii", "# rate_hz: 100", "# source: a test"] + leds.splitlines() + [COLUMNS]
    for i in range(rows):
        u = 500 + i % 7
        lines.append(f"{0.01 * i:.2f},0.75,0,0,1,{u + 97},384,4,{u - 97},{380 + i % 3},4,-1,-1,-1,-1,-1,-1")
    return "\n".join(lines) + "\n"


def read_csv(path):
    with open(path) as f:
        return [row for row in csv.reader(f) if not row[0].startswith("#")]


def message(sender, kind, payload=b""):
    body = struct.pack(">IIIiiI", 24 + len(payload), 1, 2, sender, kind, 0) + payload
    return body + b"\xee" * (-len(body) % 8)  # padding is stale memory


def name(sender, kind, text):
    return message(sender, kind, struct.pack(">I", len(text) + 1) + text.encode() + b"\0")


class Peer:
    """A VRPN peer made by hand: splits what comes into messages, with names."""

    def __init__(self, sock):
        self.sock, self.data, self.cookie, self.names = sock, b"", None, {-1: {}, -2: {}}
        sock.settimeout(20)

    def messages(self):
        """(sender, type, payload) until the other side closes."""
        while True:
            try:
                more = self.sock.recv(65536)
            except ConnectionResetError:
                return
            if not more:
                return
            self.data += more
            if self.cookie is None and len(self.data) >= 24:
                self.cookie, self.data = self.data[:24], self.data[24:]
            while self.cookie is not None and len(self.data) >= 4:
                length = struct.unpack(">I", self.data[:4])[0]
                padded = (length + 7) // 8 * 8
                if len(self.data) < padded:
                    break
                sender, kind = struct.unpack(">ii", self.data[12:20])
                payload = self.data[24:length]
                self.data = self.data[padded:]
                if kind in self.names:
                    self.names[kind][sender] = payload[4:-1].decode()
                elif kind >= 0:
                    yield self.names[-1][sender], self.names[-2][kind], payload
                else:
                    yield sender, kind, payload


class WireTest(ProgramTest):
    def serve(self, *args):
        """Starts a server; returns it and its port."""
        process = subprocess.Popen([VERISIM, "wii", "serve", "--port", "0", *map(str, args)], cwd=self.folder,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.stdout.close)
        self.addCleanup(process.stderr.close)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        first = process.stdout.readline()
        port = re.fullmatch(r"serving \S+ and \S+(?: and \S+)? at 127\.0\.0\.1:(\d+)\n", first)
        self.assertIsNotNone(port, first)
        return process, int(port[1])

    def serve_trace(self, *args, rows=60):
        return self.serve("--trace", self.write("head.csv", moving_trace(rows)), *args)

    def end(self, process, code=0):
        out, err = process.communicate(timeout=60)
        self.assertEqual(process.returncode, code, err)
        return out, err


class ServeThenListen(WireTest):
    def round_trip(self, prefix, *args):
        server, port = self.serve_trace("--wait")
        self.succeed("wii", "listen", f"WiiMote0@{prefix}127.0.0.1:{port}", "-o", self.path("got.csv"), "--poses",
                     self.path("poses.csv"), *args)
        self.end(server)
        sent, got = read_csv(self.path("head.csv")), read_csv(self.path("got.csv"))
        self.assertEqual(got[0], sent[0])
        # With --wait nothing leaves before the client is prepared, by UDP too.
        self.assertEqual(len(got), len(sent))
        for i, row in enumerate(got[1:]):
            self.assertAlmostEqual(float(row[0]), 0.01 * i, places=9)
            self.assertEqual([float(x) for x in row[1:]], [float(x) for x in sent[1 + i][1:]])
        self.assertEqual({row[1] for row in read_csv(self.path("poses.csv"))[1:]}, {"1"})

    def test_directly(self):
        self.round_trip("tcp://")

    def test_by_request_with_datagrams(self):
        self.round_trip("")

    def test_by_request_without_datagrams(self):
        self.round_trip("", "--no-udp")

    def test_at_the_pace_of_the_trace(self):
        server, port = self.serve_trace("--wait", rows=100)
        peer = Peer(socket.create_connection(("127.0.0.1", port)))
        begin = time.monotonic()
        peer.sock.sendall(COOKIE)
        list(peer.messages())
        took = time.monotonic() - begin
        peer.sock.close()
        self.end(server)
        self.assertGreater(took, 0.98)
        self.assertLess(took, 5, "about a second, on a machine that is busy")

    def test_a_live_virtual_remote(self):
        server, port = self.serve("--trajectory", "natural", "--tracker", "scaat", "--duration", "0.5", "--wait")
        report = self.run_json("wii", "listen", f"WiiMote0@tcp:127.0.0.1:{port}", "-o", self.path("got.h5"))
        self.assertGreater(report["reports"], 40)
        self.end(server)

    def test_a_trackers_poses_are_taken_as_they_come(self):
        server, port = self.serve_trace("--wait")
        report = self.run_json("wii", "listen", f"Tracker0@tcp://127.0.0.1:{port}", "--poses", self.path("heard.csv"))
        self.end(server)
        self.assertEqual(report["reports"], 60)
        self.assertIn("the server left", report["ended"])
        server2, port2 = self.serve_trace("--wait")
        note = self.succeed("wii", "listen", f"Tracker0@tcp://127.0.0.1:{port2}", "--poses", self.path("again.csv"), "--rate", "50")
        self.end(server2)
        self.assertIn("not used: --rate", note.stderr)
        self.succeed("wii", "track", "head.csv", "-o", self.path("tracked.csv"))
        heard, tracked = read_csv(self.path("heard.csv")), read_csv(self.path("tracked.csv"))
        self.assertEqual(heard[0], tracked[0])
        for a, b in zip(heard[1:], tracked[1:]):
            for x, y in zip(a[:9], b[:9]):
                self.assertAlmostEqual(float(x), float(y), places=9)
        server, port = self.serve_trace("--wait")
        self.refuse(3, "no channels", "wii", "listen", f"Tracker0@tcp://127.0.0.1:{port}", "-o", self.path("t.csv"))
        self.end(server)

    def test_says_why_it_ended_and_what_it_left_out(self):
        server, port = self.serve("--trajectory", "natural", "--wait")
        out = self.succeed("wii", "listen", f"WiiMote0@tcp://127.0.0.1:{port}", "-o", self.path("a.csv"), "--duration", "0.5").stdout
        self.assertRegex(out, r"took \d+ reports; ended: 0.5 s are over")
        server.send_signal(signal.SIGTERM)
        self.end(server, 143)

    def test_ctrl_c_ends_both_cleanly(self):
        server, port = self.serve("--trajectory", "natural", "--wait")
        listener = subprocess.Popen([VERISIM, "wii", "listen", f"WiiMote0@127.0.0.1:{port}", "-o", self.path("got.csv")],
                                    stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(listener.kill)
        time.sleep(2)
        listener.send_signal(signal.SIGINT)
        self.end(listener, 130)
        self.assertGreater(len(read_csv(self.path("got.csv"))), 5)
        server.send_signal(signal.SIGTERM)
        out, err = self.end(server, 143)
        self.assertIn("published", out)
        self.assertIn("left", err)


class Server(WireTest):
    def test_silent_clients_keep_nobody_out(self):
        server, port = self.serve_trace("--wait", rows=20)
        silent = [socket.create_connection(("127.0.0.1", port)) for _ in range(400)]
        begin = time.monotonic()
        peer = Peer(socket.create_connection(("127.0.0.1", port)))
        peer.sock.sendall(COOKIE)
        heard = [m for m in peer.messages() if m[1] == "vrpn_Analog Channel"]
        self.assertEqual(len(heard), 20)
        self.assertLess(time.monotonic() - begin, 8, "they may be silent for 10 s")
        for s in [peer.sock, *silent]:
            s.close()
        _, err = self.end(server)
        self.assertIn("sent no cookie, and others come", err)

    def test_a_peer_that_vanishes_is_asked_for(self):
        server, port = self.serve("--trajectory", "static", "--wait")
        peer = Peer(socket.create_connection(("127.0.0.1", port)))
        def timers():
            with open("/proc/net/tcp") as table:
                rows = [line.split() for line in table.readlines()[1:]]
            return {r[5][:2] for r in rows if r[1].endswith(f":{port:04X}") and r[3] == "01"}

        deadline = time.monotonic() + 10
        while timers() != {"02"} and time.monotonic() < deadline:
            time.sleep(0.05)
        self.assertEqual(timers(), {"02"}, "the timer of an idle connection is the one that asks")
        peer.sock.close()
        server.send_signal(signal.SIGTERM)
        self.end(server, 143)

    def test_a_peer_that_sends_nothing_but_its_cookie_receives_every_report(self):
        server, port = self.serve_trace("--wait", rows=20)
        peer = Peer(socket.create_connection(("127.0.0.1", port)))
        peer.sock.sendall(COOKIE)
        heard = list(peer.messages())
        peer.sock.close()
        self.end(server)
        self.assertEqual(peer.cookie, COOKIE)
        analog = [m for m in heard if m[1] == "vrpn_Analog Channel"]
        poses = [m for m in heard if m[1] == "vrpn_Tracker Pos_Quat"]
        self.assertEqual([m[0] for m in analog], ["WiiMote0"] * 20)
        self.assertEqual([m[0] for m in poses], ["Tracker0"] * 20)
        self.assertEqual(struct.unpack(">17d", analog[0][2])[:5], (16, 0.75, 0, 0, 1))
        sensor, _, *pose = struct.unpack(">ii7d", poses[0][2])
        self.assertEqual(sensor, 0)
        self.assertAlmostEqual(pose[2], 1.0, delta=0.02)
        self.assertAlmostEqual(sum(q * q for q in pose[3:]), 1, places=12)

    def test_what_is_not_valid_is_not_published(self):
        dark = moving_trace(20).replace(",384,4,", ",-1,-1,")
        server, port = self.serve("--trace", self.write("dark.csv", dark), "--wait")
        peer = Peer(socket.create_connection(("127.0.0.1", port)))
        peer.sock.sendall(COOKIE)
        self.assertEqual({m[1] for m in peer.messages()}, {"vrpn_Analog Channel"})
        peer.sock.close()
        self.end(server)

    def test_a_request_is_answered_by_a_connection_and_reports_by_datagrams(self):
        server, port = self.serve_trace("--wait", rows=40)
        waiting = socket.create_server(("127.0.0.1", 0))
        waiting.settimeout(20)
        reports = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        reports.bind(("127.0.0.1", 0))
        reports.settimeout(20)
        reports.sendto(f"127.0.0.1 {waiting.getsockname()[1]}\0".encode(), ("127.0.0.1", port))
        peer = Peer(waiting.accept()[0])
        waiting.close()
        peer.sock.sendall(COOKIE + message(reports.getsockname()[1], -3, b"127.0.0.1\0"))
        datagram = reports.recv(2000)
        self.assertGreaterEqual(len(datagram), 24)
        self.assertEqual(len(datagram) % 8, 0)
        late = [m for m in peer.messages() if m[1] == "vrpn_Analog Channel"]
        self.assertLess(len(late), 5, "reports after the description go by UDP alone")
        peer.sock.close()
        reports.close()
        self.end(server)

    def test_a_stock_client_is_greeted_and_answered(self):
        """The bytes that vrpn_print_devices sent (session c), sent again: its ids differ from the server's."""
        if not os.path.exists(GOLDEN):
            self.skipTest(f"no recordings at {GOLDEN}: nothing was compared")
        with open(GOLDEN) as f:
            session = next(s for s in json.load(f)["sessions"] if s["id"] == "c")
        stream = b"".join(bytes.fromhex(e["bytes"]) for e in session["events"]
                          if e["via"] == "tcp" and e["from"] == "client" and "bytes" in e)
        server, port = self.serve_trace("--wait", "--channels", "Analog0", rows=30)
        peer = Peer(socket.create_connection(("127.0.0.1", port)))
        peer.sock.sendall(stream)
        heard = list(peer.messages())
        peer.sock.close()
        self.end(server)
        said = [m[:2] for m in heard]
        pings = sum(e.get("type_name") == "vrpn_Base ping_message" for e in session["events"] if e["from"] == "client")
        self.assertEqual(said.count(("Tracker0", "vrpn_Base pong_message")), pings)
        self.assertEqual(said.count(("Tracker0", "vrpn_Tracker Pos_Quat")), 30)

    def test_tracker_requests_are_answered(self):
        server, port = self.serve_trace("--wait", rows=30)
        peer = Peer(socket.create_connection(("127.0.0.1", port)))
        asked = ["vrpn_Tracker Request_Tracker_To_Room", "vrpn_Tracker Request_Unit_To_Sensor",
                 "vrpn_Tracker Request_Tracker_Workspace"]
        stream = COOKIE + name(3, -1, "Tracker0")
        for i, text in enumerate(asked):
            stream += name(10 + i, -2, text) + message(3, 10 + i)
        peer.sock.sendall(stream)
        sizes = {m[1]: len(m[2]) for m in peer.messages()}
        peer.sock.close()
        self.end(server)
        self.assertEqual(sizes["vrpn_Tracker To_Room"], 56)
        self.assertEqual(sizes["vrpn_Tracker Unit_To_Sensor"], 64)
        self.assertEqual(sizes["vrpn_Tracker Workspace"], 48)

    def test_bad_clients_disturb_nobody(self):
        server, port = self.serve_trace("--wait", rows=100)
        good = Peer(socket.create_connection(("127.0.0.1", port)))
        good.sock.sendall(COOKIE)
        bad = []
        for stream in [b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n", COOKIE + struct.pack(">I", 1 << 30) + b"x" * 100,
                       COOKIE + message(0, -2000), COOKIE[:12], COOKIE + message(1, 1, b"x" * 64)[:40]]:
            bad.append(socket.create_connection(("127.0.0.1", port)))
            bad[-1].sendall(stream)
        heard = sum(m[1] == "vrpn_Analog Channel" for m in good.messages())
        for sock in [good.sock, *bad]:
            sock.close()
        _, err = self.end(server)
        self.assertEqual(heard, 100)
        for word in ["protocol 07", "impossible length", "type -2000"]:
            self.assertIn(word, err)

    def test_refuses_what_cannot_be_served(self):
        head = self.write("head.csv", moving_trace())
        with socket.create_server(("127.0.0.1", 0)) as taken:
            port = taken.getsockname()[1]
            self.refuse(5, [str(port), "in use"], "wii", "serve", "--trace", head, "--port", port)
        self.refuse(5, "no.such.host.invalid", "wii", "serve", "--trace", head, "--host", "no.such.host.invalid")
        self.refuse(3, "nowhere.csv", "wii", "serve", "--trace", "nowhere.csv", "--port", 0)
        self.refuse(2, "--trace", "wii", "serve", "--port", 0)
        self.refuse(2, "stereo", "wii", "serve", "--trace", head, "--tracker", "stereo")
        self.refuse(2, "a@b", "wii", "serve", "--trace", head, "--port", 0, "--device", "a@b")
        self.refuse(3, "three-led", "wii", "serve", "--trace", head, "--port", 0, "--tracker", "three-led")


class Listener(WireTest):
    def listen(self, stream, *args):
        """A server made by hand that accepts one client, says `stream`, and leaves."""
        with socket.create_server(("127.0.0.1", 0)) as waiting:
            waiting.settimeout(20)
            device = f"WiiMote0@tcp:127.0.0.1:{waiting.getsockname()[1]}"
            process = subprocess.Popen([VERISIM, "wii", "listen", device, "-o", self.path("got.csv"), *args],
                                       stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            self.addCleanup(process.kill)
            sock = waiting.accept()[0]
            with sock:
                sock.sendall(stream)
                sock.settimeout(0.5)
                try:
                    while sock.recv(65536):
                        pass
                except TimeoutError:
                    pass
        return process

    @staticmethod
    def analog(values, usec, sender=7, kind=3):
        payload = struct.pack(f">{1 + len(values)}d", len(values), *values)
        body = struct.pack(">IIIiiI", 24 + len(payload), 100, usec, sender, kind, 0) + payload
        return body + b"\xaa" * (-len(body) % 8)

    def test_takes_what_a_trace_can_hold_and_counts_the_rest(self):
        good = [0.5, 0, 0, 1] + [500.0, 300.0, 4.0] * 4
        nan = [float("nan")] + good[1:]
        stream = COOKIE + name(7, -1, "WiiMote0") + name(8, -1, "Other") + name(3, -2, "vrpn_Analog Channel")
        stream += self.analog(good, 1000) + self.analog(good, 1000) + self.analog(good, 500) + self.analog(nan, 2000)
        stream += self.analog(good[:14], 3000) + self.analog(good[:15], 11000) + self.analog(good, 21000, sender=8)
        process = self.listen(stream)
        out, _ = self.end(process)
        self.assertIn("took 2 reports; ended: the server left", out)
        self.assertIn("left out 1 reports with fewer than 15 channels, 1 not finite, 2 not later than the one before", out)
        rows = read_csv(self.path("got.csv"))[1:]
        self.assertEqual([float(r[0]) for r in rows], [0, 0.01])
        self.assertEqual(float(rows[1][16]), -1, "15 channels leave slot 3 without its size")

    def test_a_server_without_the_device_or_with_nonsense_is_an_error(self):
        _, err = self.end(self.listen(COOKIE), 3)
        self.assertIn("no report", err)
        _, err = self.end(self.listen(b"HTTP/1.1 400 Bad Request\r\n\r\n", "--patience", "1"), 5)
        self.assertIn("protocol 07", err)

    def test_nobody_there_is_an_error_after_some_patience(self):
        with socket.create_server(("127.0.0.1", 0)) as taken:
            port = taken.getsockname()[1]
        out = ["-o", self.path("x.csv"), "--patience", "0.3"]
        self.refuse(5, "no VRPN server answered", "wii", "listen", f"WiiMote0@127.0.0.1:{port}", *out)
        self.refuse(5, "nobody listens", "wii", "listen", f"WiiMote0@tcp://127.0.0.1:{port}", *out)
        self.refuse(2, "nothing to write", "wii", "listen", "WiiMote0@localhost")
        self.refuse(2, "DEVICE@HOST", "wii", "listen", "WiiMote0", *out)
        self.refuse(3, "leds", "wii", "listen", "WiiMote0@localhost", *out, "--leds", "1 2")


if __name__ == "__main__":
    unittest.main()
