"""Every shared recording becomes a trace by one documented command (README, traces)."""
import os
import re
import shlex
import unittest

from program import ProgramTest, SHARED, SOURCE

RECORDINGS = os.path.join(SHARED, "traces")


def documented_commands():
    """The convert commands of traces/README.md, as words."""
    with open(os.path.join(SOURCE, "traces", "README.md")) as f:
        text = f.read().replace("\\\n", " ")
    return [shlex.split(line)[1:] for line in text.splitlines() if line.startswith("verisim trace convert")]


class Traces(ProgramTest):
    @unittest.skipUnless(os.path.isdir(RECORDINGS), "the shared recordings are not there")
    def test_every_recording_converts_by_the_documented_command(self):
        commands = documented_commands()
        covered = set()
        for command in commands:
            words = [re.sub(r"^RECORDINGS", RECORDINGS, w) for w in command]
            source = next(w for w in words if w.startswith(RECORDINGS))
            folder, pattern = os.path.split(source)
            for name in sorted(os.listdir(folder)):
                if not re.fullmatch(pattern.replace("*", ".*"), name):
                    continue
                covered.add(os.path.join(folder, name))
                out = self.path("out.csv")
                self.succeed(*[os.path.join(folder, name) if w == source else out if w.endswith(".csv") and "/" not in w else w
                               for w in words])
                report = self.run_json("trace", "info", out, "--allow-gaps")
                self.assertGreater(report["samples"], 1000, name)
        recordings = {os.path.join(d, f) for d, _, files in os.walk(RECORDINGS) for f in files
                      if f.endswith(".csv") and "metadata" not in f}
        self.assertEqual(recordings - covered, set())

    def test_synthesized_traces_drive_a_device(self):
        self.succeed("trace", "synth", "reach", "-o", self.path("reach.csv"))
        self.succeed("trace", "convert", self.path("reach.csv"), "-o", self.path("reach.h5"))
        self.assertEqual(self.run_json("trace", "info", self.path("reach.csv"))["samples"],
                         self.run_json("trace", "info", self.path("reach.h5"))["samples"])
        self.write("s.lua", """
local box = addObject{ name = "box", voxelsize = 0.01, Solid.box{0.1, 0.1, 0.1} }
local omni = Devices.Sensable.PhantomOmni{ name = "omni", scale = 4 }
addDevice(omni)
grasp(omni, box)""")
        run_file = self.path("s.h5")
        summary = self.run_json("run", self.path("s.lua"), "--bind", "omni=" + self.path("reach.h5"), "-o", run_file)
        self.assertGreater(summary["frames"], 500)
        self.succeed("replay", run_file, "--verify")

    def test_synthesized_drives_of_the_robot_are_encoder_traces(self):
        for path, end in {"straight": (1, 0, 0), "strafe": (0, 1, 0), "turn": (0, 0, 6.2831853),
                          "square": (0, 0, 6.2831853), "circle": (0, 0, 6.2831853)}.items():
            out = self.path(path + ".csv")
            self.succeed("trace", "synth", "encoder", "--path", path, "-o", out, "--set", "rate=50")
            report = self.run_json("trace", "info", out)
            self.assertEqual((report["kind"], report["rate_hz"]), ("encoder", 50))
            with open(out) as f:
                rows = f.read().splitlines()
            self.assertEqual(rows[4], "t,e0,e1,e2,e3,vx,vy,omega,x,y,theta")
            for value, expected in zip(rows[-1].split(",")[-3:], end):
                self.assertAlmostEqual(float(value), expected, places=7)
        self.refuse(2, "did you mean 'square'", "trace", "synth", "encoder", "--path", "sqare", "-o", self.path("no.csv"))
        self.refuse(2, "only encoder has", "trace", "synth", "sine", "--path", "square", "-o", self.path("no.csv"))

    def test_a_device_that_nothing_drives_stays_and_says_so(self):
        self.write("s.lua", 'defineSimulationParameters{duration = 0.1}\n'
                   'addDevice(Devices.Sensable.PhantomOmni{ name = "omni" })')
        done = self.succeed("run", self.path("s.lua"), "-o", self.path("s.h5"))
        self.assertIn("driven by nothing", done.stderr)


if __name__ == "__main__":
    unittest.main()
