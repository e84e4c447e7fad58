"""wii judge: a tracker of the user's own, from files, as a program and over VRPN, by the rows of wii validate."""
import csv
import json
import os
import re
import subprocess
import unittest

from program import SHARED, SOURCE, VERISIM, ProgramTest

RECORDED = os.path.join(SHARED, "..", "reference", "wii")
POSE = ["px", "py", "pz", "qx", "qy", "qz", "qw"]


class Judge(ProgramTest):
    def synth(self, *args, name="head.csv"):
        self.succeed("trace", "synth", "wii", *args, "-o", self.path(name))
        return self.path(name)

    def poses(self, trace, tracker="geometric", *args):
        self.succeed("wii", "track", trace, "--tracker", tracker, *args, "-o", self.path("poses.csv"))
        return self.path("poses.csv")

    def judged(self, *args):
        return self.run_json("wii", "judge", *args)

    def rows_of(self, path):
        with open(path) as f:
            return list(csv.DictReader(f))

    def test_the_row_is_that_of_the_validation(self):
        trace = self.synth("--trajectory", "natural", "--sensor", "wiimote", "--seed", "3")
        for tracker in ("geometric", "vrpn-compatible", "scaat"):
            row, = self.judged(self.poses(trace, tracker, "--full"), "--trace", trace, "--name", tracker)["rows"]
            own, = self.run_json("wii", "validate", "--trajectory", "natural", "--sensor", "wiimote", "--seed", "3",
                                 "--tracker", tracker)["rows"]
            for key in own.keys() - {"trajectory", "sensor", "update_ns"}:
                self.assertEqual(row[key], own[key], (tracker, key))
            os.remove(self.path("poses.csv"))

    @unittest.skipUnless(os.path.isdir(RECORDED), "the recordings of stock VRPN's tracker are not there")
    def test_stocks_own_poses_give_the_row_of_vrpn_compatible(self):
        for name in ("static_centre", "sweep_x"):
            recorded = os.path.join(RECORDED, name + ".csv")
            with open(recorded) as f:
                rows = list(csv.DictReader(f))
            channels = ["battery", "gx", "gy", "gz"] + [f"{a}{i}" for i in range(1, 5) for a in "xys"]
            lines = ["# verisim-trace 1", "# kind: wii", "# rate_hz: 100", "# source: a test", ",".join(["t", *channels, *POSE])]
            lines += [",".join([r["t"], *(r[f"ch{i}"] for i in range(16)), *(r[p] for p in POSE)]) for r in rows]
            trace = self.write(name + "_trace.csv", "\n".join(lines) + "\n")
            columns = "valid=up_lock " + " ".join(f"{p}=up_{p}" for p in POSE)
            stock, = self.judged(recorded, "--columns", columns, "--trace", trace)["rows"]
            ours, = self.judged(self.poses(trace, "vrpn-compatible"), "--trace", trace)["rows"]
            os.remove(self.path("poses.csv"))
            for key in ("reports", "valid", "availability", "false_validity"):
                self.assertEqual(stock[key], ours[key], key)
            for what in ("position_m", "orientation_deg"):
                for key in ("rms", "p95", "max"):
                    self.assertAlmostEqual(stock[what][key], ours[what][key], delta=2e-7 + 1e-6 * ours[what][key])
            self.assertIsNone(stock["nees"])

    def test_tum_of_another_clock_and_coordinates(self):
        trace = self.synth("--trajectory", "natural", "--sensor", "noisy")
        poses = self.rows_of(self.poses(trace))
        plain, = self.judged(self.path("poses.csv"), "--trace", trace)["rows"]
        # Turned by 90 degrees about up, elsewhere, an hour later: (x, y, z) -> (z + 1, y, -x).
        half = 0.5 ** 0.5
        lines = ["# a TUM file"]
        for r in poses:
            x, y, z, qx, qy, qz, qw = (float(r[p]) for p in POSE)
            q = (half * (qx + qz), half * (qy + qw), half * (qz - qx), half * (qw - qy))
            lines.append(" ".join(repr(v) for v in (float(r["t"]) + 3600, z + 1, y, -x, *q)))
        tum = self.write("tum.txt", "\n".join(lines) + "\n")
        self.refuse(3, ["tum.txt", "time offset"], "wii", "judge", tum, "--trace", trace)
        said = self.judged(tum, "--trace", trace, "--time-offset", "start", "--align", "yaw")
        self.assertAlmostEqual(said["time_offset_s"], -3600, places=6)
        self.assertAlmostEqual(said["aligned_by"][0], 0, delta=0.01)
        self.assertAlmostEqual(said["aligned_by"][2], -1, delta=0.01)
        self.assertAlmostEqual(said["rows"][0]["position_m"]["rms"], plain["position_m"]["rms"], delta=2e-4)
        self.assertAlmostEqual(said["rows"][0]["orientation_deg"]["rms"], plain["orientation_deg"]["rms"], delta=0.1)

    def test_a_program_is_asked_line_by_line(self):
        self.write("mine.py", "import sys\nfor line in sys.stdin:\n"
                              "    f = line.split(',')\n    assert len(f) == 17\n"
                              "    print(f[0] + ',1,0,0,1,0,0,0,1', flush=True)\n")
        said = self.judged("--program", "python3 " + self.path("mine.py"), "--trajectory", "static", "--sensor", "ideal")
        self.assertEqual(said["rows"][0]["valid"], 500)
        self.assertLess(said["rows"][0]["position_m"]["max"], 1e-12)
        self.assertIsNone(said["time_offset_better_s"])
        for program, words in [("true", "has ended"), ("exec <&-; sleep 0.2", "has ended"), ("echo nonsense; cat >/dev/null", "'nonsense', not a number"),
                               ("sleep 60", "has said nothing for 0.5 s")]:
            self.refuse(3, words, "wii", "judge", "--program", program, "--trajectory", "static", "--patience", "0.5")

    def test_a_tracker_over_vrpn(self):
        """Another Verisim plays the same head for itself as Tracker0; a listener takes our channels in its place."""
        motion = self.write("motion.csv", "\n".join(
            ["# verisim-trace 1", "# kind: haptic", "# rate_hz: 10", "# source: a test", "t," + ",".join(POSE)] +
            [f"{0.1 * i:.1f},{0.1 * (i % 20 - 10) / 10 if i % 40 < 20 else 0.1 * (10 - i % 20) / 10},0.0,{1 + 0.003 * i},0,0,0,1"
             for i in range(40)]) + "\n")
        serve = subprocess.Popen([VERISIM, "wii", "serve", "--motion", motion, "--sensor", "noisy", "--port", "0", "--wait"],
                                 cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        self.addCleanup(serve.stdout.close)
        self.addCleanup(serve.wait)
        self.addCleanup(serve.kill)
        port = re.search(r":(\d+)\n", serve.stdout.readline())[1]
        judge = subprocess.Popen([VERISIM, "wii", "judge", f"Tracker0@127.0.0.1:{port}", "--motion", motion, "--sensor",
                                  "noisy", "--serve-port", "0", "--json", "--time-offset", "found"], cwd=self.folder,
                                 stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(judge.stdout.close)
        self.addCleanup(judge.stderr.close)
        self.addCleanup(judge.wait)
        self.addCleanup(judge.kill)
        ours = re.search(r"WiiMote0 at 127\.0\.0\.1:(\d+)", judge.stderr.readline())[1]
        listen = subprocess.run([VERISIM, "wii", "listen", f"WiiMote0@127.0.0.1:{ours}", "-o", self.path("heard.csv")],
                                cwd=self.folder, capture_output=True, text=True, timeout=60)
        out, err = judge.communicate(timeout=60)
        self.assertEqual(judge.returncode, 0, err)
        self.assertEqual(listen.returncode, 0, listen.stderr)
        said = json.loads(out)
        self.assertEqual(said["rows"][0]["tracker"], f"Tracker0@127.0.0.1:{port}")
        self.assertGreater(said["rows"][0]["valid"], 300)
        self.assertLess(said["rows"][0]["position_m"]["rms"], 0.02)
        with open(self.path("heard.csv")) as f:
            heard = sum(1 for line in f if line[0].isdigit())
        self.assertEqual(heard, said["samples"])

    def test_files_are_those_of_the_validation(self):
        trace = self.synth("--trajectory", "static", "--sensor", "noisy")
        self.succeed("wii", "judge", self.poses(trace), "--trace", trace, "-o", self.path("row.csv"))
        self.assertEqual(len(self.rows_of(self.path("row.csv"))), 1)
        for plot in ("row.svg", "row-time.svg"):
            self.assertTrue(os.path.getsize(self.path(plot)) > 500, plot)

    def test_refuses_what_it_cannot_judge(self):
        trace = self.synth("--trajectory", "static", "--sensor", "noisy")
        poses = self.poses(trace)
        self.refuse(2, "one of them", "wii", "judge")
        self.refuse(2, "leave one of them out", "wii", "judge", poses, "--trace", trace, "--sensor", "ideal")
        self.refuse(2, "--columns: is of a file", "wii", "judge", "--program", "true", "--columns", "t=t")
        self.refuse(2, "--serve-port: is of a tracker", "wii", "judge", poses, "--trace", trace, "--serve-port", "0")
        self.refuse(2, "--resort: is of --trace", "wii", "judge", poses, "--resort")
        self.refuse(2, "leave one of them out", "wii", "judge", poses, "--trace", trace, "--seed", "2")
        self.refuse(2, "--time-offset", "wii", "judge", poses, "--trace", trace, "--time-offset", "soon")
        self.refuse(2, "no column of that name", "wii", "judge", poses, "--trace", trace, "--columns", "px=nowhere")
        self.refuse(3, ["head moves", "alignment"], "wii", "judge", poses, "--trace", trace, "--align", "se3")
        self.refuse(3, ["short.csv:2", "complete the row"], "wii", "judge", self.write("short.csv", "t,valid,px,py,pz,qx,qy,qz,qw\n0,1,2\n"),
                    "--trace", trace)
        self.refuse(3, ["tum.txt:1", "TUM"], "wii", "judge", self.write("tum.txt", "0 1 2 3\n"), "--trace", trace)
        self.refuse(3, "no column 't'", "wii", "judge", self.write("other.csv", "a,b\n1,2\n"), "--trace", trace)


class SetUp(ProgramTest):
    def test_a_motions_own_set_up_counts_and_the_command_line_before_it(self):
        motion = self.write("motion.csv", "\n".join(
            ["# verisim-trace 1", "# kind: haptic", "# rate_hz: 10", "# source: a test", "# leds: 0.1 0 0; -0.1 0 0",
             "# fov_deg: 33 23", "t," + ",".join(POSE)] + [f"{0.1 * i:.1f},0,0,1,0,0,0,1" for i in range(5)]) + "\n")
        for args, leds, fov in [([], "0.1 0 0; -0.1 0 0", "33 23"),
                                (["--leds", "0.05 0 0; -0.05 0 0", "--fov", "45", "27"], "0.05 0 0; -0.05 0 0", "45 27")]:
            self.succeed("trace", "synth", "wii", "--motion", motion, "--sensor", "ideal", *args, "-o", self.path("out.csv"))
            info = self.run_json("trace", "info", self.path("out.csv"))
            self.assertEqual((info["leds"], info["fov_deg"]), (leds, fov))
            os.remove(self.path("out.csv"))
        done = self.succeed("wii", "validate", "--motion", motion, "--sensor", "ideal")
        self.assertIn("three-led is left out", done.stderr)
        self.assertIn("scaat/3 is left out", done.stderr)
        self.assertNotIn("scaat/3", done.stdout)

    def test_seeds_give_an_interval(self):
        rows = self.run_json("wii", "validate", "--trajectory", "static", "--sensor", "noisy", "--seeds", "4")["rows"]
        for row in rows:
            low, high = row["position_rms_95_m"]
            self.assertTrue(low < row["position_m"]["rms"] < high)
            self.assertEqual(row["seeds"], 4)

    def test_glasses_of_ones_own_leave_out_who_needs_more_and_say_so(self):
        done = self.succeed("wii", "validate", "--trajectory", "static", "--sensor", "ideal", "--leds", "0.1 0 0; -0.1 0 0")
        self.assertIn("three-led is left out", done.stderr)
        self.assertNotIn("three-led", done.stdout)
        self.refuse(3, "glasses of its own", "wii", "validate", "--tracker", "scaat/3", "--leds", "0.1 0 0; -0.1 0 0")

    def test_a_set_up_is_of_a_virtual_remote_alone(self):
        self.refuse(2, "only wii has", "trace", "synth", "sine", "--rate", "50", "-o", self.path("x.csv"))
        self.refuse(3, "moves the remote itself", "trace", "synth", "wii", "--trajectory", "moving-remote", "--remote-pose",
                    "0", "0", "0", "0", "0", "0", "1", "-o", self.path("x.csv"))


class Readme(ProgramTest):
    def test_its_three_commands_print_what_it_shows(self):
        with open(os.path.join(SOURCE, "README.md")) as f:
            section = f.read().split("## Validate your own tracker")[1].split("```")[1]
        commands = [line[2:].split("#")[0].split() for line in section.splitlines() if line.startswith("$ ")]
        shown = section.split(" ".join(commands[-1]))[1]
        for command in commands:
            self.assertEqual(command[0], "build/verisim")
            printed = self.succeed(*command[1:]).stdout
        self.assertEqual(printed.strip(), shown.strip())


if __name__ == "__main__":
    unittest.main()
