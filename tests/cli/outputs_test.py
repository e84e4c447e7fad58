"""-o replaces only a file of the kind that the command writes; --force any other plain file; an input, a device, a FIFO
and a folder never. Runs at the same time never share a name that they were not given."""
import json
import os
import re
import shutil
import socket
import subprocess
import unittest

import h5py

from program import ProgramTest, SMALL, VERISIM

FOREIGN = {  # what a user would miss; none is empty
    "a text": b"my notes\n", "a table": b"a,b\n1,2\n", "a script": SMALL.encode(), "bytes": bytes(range(256)),
    "a broken HDF5 file": b"\x89HDF\r\n\x1a\n" + bytes(40), "a drawing": b"<?xml version='1.0'?>\n<svg/>\n",
}


def timed_objects(content):
    """Objects of an HDF5 file, and how many of them keep times: bit 5 of the flags of a header of version 2."""
    headers = [found.start() for found in re.finditer(b"OHDR\x02", content)]
    return len(headers), sum(content[at + 5] >> 5 & 1 for at in headers)


class Outputs(ProgramTest):
    def setUp(self):
        super().setUp()
        self.write("small.lua", SMALL)
        self.succeed("trace", "synth", "sine", "-o", "in.csv", "--set", "duration=0.1")
        self.write("wii.csv", "# verisim-trace 1\n# kind: wii\n# rate_hz: 100\n# source: x\n"
                   "t,battery,gx,gy,gz,x1,y1,s1,x2,y2,s2,x3,y3,s3,x4,y4,s4\n0,1,0,0,1" + ",-1" * 12 + "\n")
        # Every command that writes: what it is called with, and its output.
        self.commands = {
            "run": (["run", "small.lua", "--quiet"], "out.h5"),
            "convert": (["trace", "convert", "in.csv"], "out.csv"),
            "convert to HDF5": (["trace", "convert", "in.csv"], "out.h5"),
            "synth": (["trace", "synth", "sine", "--set", "duration=0.1"], "out.csv"),
            "track": (["wii", "track", "wii.csv"], "out.csv"),
            "validate": (["wii", "validate", "--tracker", "geometric", "--trajectory", "static", "--sensor", "ideal"],
                         "out.csv"),
        }

    def each(self):
        for name, (command, out) in self.commands.items():
            for beside in os.listdir(self.folder):
                if beside.startswith("out"):
                    os.remove(self.path(beside))
            with self.subTest(command=name):
                yield [*command, "-o", out], out

    def content(self, name):
        with open(self.path(name), "rb") as f:
            return f.read()

    def test_its_own_kind_is_replaced_and_an_empty_file(self):
        for command, out in self.each():
            self.write(out, b"")
            self.succeed(*command)
            self.assertGreater(os.path.getsize(self.path(out)), 0)
            self.succeed(*command)

    def test_every_other_plain_file_stays_unless_forced(self):
        for command, out in self.each():
            for what, content in FOREIGN.items():
                with self.subTest(what):
                    self.write(out, content)
                    self.refuse(5, [out, "--force"], *command)
                    self.assertEqual(self.content(out), content)
            self.succeed(*command, "--force")
            self.assertNotEqual(self.content(out), content)

    def test_one_kind_does_not_replace_another(self):
        made = {}
        for command, out in self.each():
            self.succeed(*command)
            made[command[0] + command[1]] = self.content(out)
        for command, out in self.each():
            for other, content in made.items():
                same_kind = other == command[0] + command[1] or (command[0] == "trace" and other.startswith("trace"))
                if not same_kind:
                    with self.subTest(other=other):
                        self.write(out, content)
                        self.refuse(5, out, *command)

    def test_folders_devices_fifos_and_sockets_never(self):
        for command, out in self.each():
            for force in ([], ["--force"]):
                os.mkfifo(self.path("fifo"))
                os.mkdir(self.path("folder"))
                with socket.socket(socket.AF_UNIX) as s:
                    s.bind(self.path("socket"))
                    os.symlink("fifo", self.path("link"))
                    for place, kind in (("fifo", "a FIFO"), ("folder", "a folder"), ("folder/", "a folder"),
                                        ("none/", "a folder"), ("socket", "a socket"), ("link", "a FIFO"),
                                        ("/dev/null", "a device"), ("/dev/full", "a device"), (".", "a folder")):
                        self.refuse(5, [place, kind], *command[:-1], place, *force, timeout=60)
                for name in ("fifo", "socket", "link"):
                    os.remove(self.path(name))
                os.rmdir(self.path("folder"))

    def test_what_stands_under_the_names_used_while_writing(self):
        for command, out in self.each():
            self.write(out + ".part", "my notes\n")
            self.refuse(5, out + ".part", *command)
            self.assertEqual(self.content(out + ".part"), b"my notes\n")
            os.remove(self.path(out + ".part"))
            self.write("precious", "precious\n")
            os.symlink("precious", self.path(out + ".part"))
            self.refuse(5, out + ".part", *command, "--force")
            self.assertEqual(self.content("precious"), b"precious\n")
            os.remove(self.path(out + ".part"))
            os.mkfifo(self.path(out + ".part"))
            self.refuse(5, out + ".part", *command, timeout=60)

    def test_a_link_is_written_through(self):
        for command, out in self.each():
            if os.path.exists(self.path("far")):
                shutil.rmtree(self.path("far"))
            os.mkdir(self.path("far"))
            os.symlink(os.path.join("far", out), self.path(out))
            self.refuse(5, "leads nowhere", *command)
            self.write(os.path.join("far", out), "")
            self.succeed(*command)
            self.assertTrue(os.path.islink(self.path(out)))
            self.assertGreater(os.path.getsize(self.path("far/" + out)), 0)

    def test_inputs_never_by_whatever_name(self):
        self.write("other.lua", "return 1")
        self.write("with.lua", SMALL + 'dofile("other.lua")\nDevices.Replay{ name = "r", trace = "in.csv" }\n'
                   'addDevice(Devices.Sensable.PhantomOmni{ name = "omni" })')
        self.succeed("trace", "synth", "sine", "-o", "bound.csv", "--set", "duration=0.1")
        with_all = ["run", "with.lua", "--bind", "omni=bound.csv", "--quiet"]
        self.write("wii2.csv", self.content("wii.csv").replace(b"# source", b"# remote_pose: 0 0 0 0 0 0 1\n# source"))
        readers = [(with_all, ["with.lua", "other.lua", "bound.csv"]),
                   (["trace", "convert", "in.csv"], ["in.csv"]),
                   (["wii", "track", "wii.csv"], ["wii.csv"]),
                   (["wii", "track", "wii2.csv", "--second", "wii2.csv", "--tracker", "stereo"], ["wii2.csv"]),
                   (["wii", "validate", "--tracker", "geometric", "--motion", "in.csv"], ["in.csv"])]
        os.mkdir(self.path("sub"))
        for command, inputs in readers:
            for name in inputs:
                before = self.content(name)
                links = [name, "./sub/../" + name, self.path(name), "hard.csv", "soft.csv"]
                os.link(self.path(name), self.path("hard.csv"))
                os.symlink(name, self.path("soft.csv"))
                for place in links:
                    for force in ([], ["--force"]):
                        with self.subTest(command=command, place=place, force=force):
                            self.refuse(5, "is an input", *command, "-o", place, *force)
                            self.assertEqual(self.content(name), before)
                os.remove(self.path("hard.csv"))
                os.remove(self.path("soft.csv"))

    def test_an_input_beside_the_output(self):
        """validate writes plots beside its table: one of them must not be an input either."""
        shutil.copy(self.path("in.csv"), self.path("t.svg"))
        shutil.copy(self.path("in.csv"), self.path("u-in-ideal.svg"))
        for motion, out in (("t.svg", "t.csv"), ("u-in-ideal.svg", "u.csv")):
            os.rename(self.path(motion), self.path("kept"))
            os.link(self.path("kept"), self.path(motion))
            os.remove(self.path("in.csv"))
            os.link(self.path("kept"), self.path("in.csv"))
            self.refuse(5, [motion, "is an input"], "wii", "validate", "--tracker", "geometric", "--sensor", "ideal",
                        "--trajectory", "static", "--motion", "in.csv", "-o", out, "--force")

    def test_a_folder_of_results_keeps_what_is_not_of_them(self):
        os.mkdir(self.path("r"))
        self.write("r/r7_coverage.csv", "my notes\n")
        self.refuse(5, ["r7_coverage.csv", "--force"], "reproduce", "--only", "R7", "--quick", "--quiet", "-o", "r")
        self.succeed("reproduce", "--only", "R7", "--quick", "--quiet", "-o", "r", "--force")
        self.succeed("reproduce", "--only", "R7", "--quick", "--quiet", "-o", "r")

    def test_no_object_of_hdf5_keeps_a_time(self):
        with h5py.File(self.path("timed.h5"), "w", libver="latest") as f:
            f.create_dataset("a", data=[1], track_times=True)
        self.assertGreater(timed_objects(self.content("timed.h5"))[1], 0)
        for command, out in self.each():
            if not out.endswith(".h5"):
                continue
            self.succeed(*command)
            objects, timed = timed_objects(self.content(out))
            self.assertGreater(objects, 3)
            self.assertEqual(timed, 0)

    def test_a_killed_runs_file_is_a_run_file(self):
        process = subprocess.Popen([VERISIM, "run", "small.lua", "-o", "out.h5", "--duration", "600", "--quiet"],
                                   cwd=self.folder)
        while not os.path.exists(self.path("out.h5")):
            self.assertIsNone(process.poll())
        process.kill()
        process.wait()
        self.succeed("run", "small.lua", "-o", "out.h5", "--quiet")

    def test_runs_at_the_same_time_have_names_of_their_own(self):
        count = 4
        runs = [subprocess.Popen([VERISIM, "run", "small.lua", "--json", "--realtime", "--duration", "1.5"],
                                 cwd=self.folder, stdout=subprocess.PIPE, text=True) for _ in range(count)]
        files = [json.loads(run.communicate()[0])["run_file"] for run in runs]
        self.assertEqual([run.returncode for run in runs], [0] * count)
        self.assertEqual(len(set(files)), count)
        self.assertIn("runs/small.h5", files)
        self.assertIn("runs/small-2.h5", files)
        for file in files:
            with h5py.File(self.path(file)) as f:
                self.assertEqual(len(f["/state/time"]), 1500)

    def test_results_at_the_same_time_have_folders_of_their_own(self):
        both = [subprocess.Popen([VERISIM, "reproduce", "--only", "R7", "--quick", "--quiet", "--json"], cwd=self.folder,
                                 stdout=subprocess.PIPE, text=True) for _ in range(2)]
        folders = {os.path.dirname(file) for one in both for file in json.loads(one.communicate()[0])["runs"]}
        self.assertEqual(folders, {"runs/reproduce", "runs/reproduce-2"})
        self.assertEqual(os.listdir(self.path("runs/reproduce")), ["r7_coverage.csv"])

    def test_two_outputs_of_one_name(self):
        self.refuse(2, "a.csv", "wii", "listen", "W@127.0.0.1:1", "-o", "a.csv", "--poses", "a.csv")
        self.refuse(2, "a.svg", "wii", "validate", "-o", "a.svg")

    def test_a_name_that_was_given_is_not_changed(self):
        command = [VERISIM, "run", "small.lua", "-o", "out.h5", "--realtime", "--quiet"]
        first = subprocess.Popen([*command, "--duration", "600"], cwd=self.folder)
        while not os.path.exists(self.path("out.h5")):
            self.assertIsNone(first.poll())
        self.refuse(5, "another run is writing it", *command[1:])
        self.refuse(5, "another run is writing it", *command[1:], "--force")
        first.terminate()
        self.assertEqual(first.wait(), 143)


if __name__ == "__main__":
    unittest.main()
