"""Every long command ends at the first signal, with exit code 128 + its number, and says so; what it wrote is whole."""
import json
import os
import signal
import subprocess
import time
import unittest

import h5py

from program import ProgramTest, SMALL, VERISIM

SIGNALS = [signal.SIGINT, signal.SIGTERM, signal.SIGHUP]
LONG = "12" if os.environ["VERISIM_SANITIZE"] else "120"  # s, whose replay takes long: the sanitizers are ten times slower
SOON = 20  # s, for the slowest machine and sanitizer; usual are milliseconds


class Interrupts(ProgramTest):
    def setUp(self):
        super().setUp()
        self.write("small.lua", SMALL)

    def start(self, *command, **options):
        return subprocess.Popen([VERISIM, *command], cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                text=True, **options)

    def interrupt(self, process, number):
        process.send_signal(number)
        out, err = process.communicate(timeout=SOON)
        self.assertEqual(process.returncode, 128 + number, err)
        self.assertEqual(err.count("error: "), 1, err)
        self.assertIn(f"error: interrupted by {number.name}", err)
        return out

    def wait_for(self, name, process):
        while not os.path.exists(self.path(name)):
            self.assertIsNone(process.poll(), "ended by itself")
            time.sleep(0.002)

    def wait_until_caught(self, number, process):
        """On a busy machine a program may take long to come to its first line."""
        def caught():
            with open(f"/proc/{process.pid}/status") as f:
                mask = next(line.split()[1] for line in f if line.startswith("SigCgt:"))
            return int(mask, 16) >> (number - 1) & 1
        while process.poll() is None and not caught():
            time.sleep(0.002)

    def test_a_run_closes_its_file(self):
        for number in SIGNALS:
            for pace in ([], ["--realtime"]):
                name = f"{number.name}{len(pace)}.h5"
                process = self.start("run", "small.lua", "-o", name, "--duration", "600", "--json", *pace)
                self.wait_for(name, process)
                summary = json.loads(self.interrupt(process, number))
                with h5py.File(self.path(name)) as f:
                    self.assertEqual(len(f["/state/time"]), summary["frames"])
                    self.assertEqual(f["/summary"].attrs["end"], "interrupted")
        self.succeed("replay", name, "--verify")

    def test_every_other_long_command_ends_at_once(self):
        self.succeed("run", "small.lua", "-o", "long.h5", "--duration", LONG, "--quiet")
        commands = [["replay", "long.h5"], ["replay", "long.h5", "--verify"], ["wii", "validate"],
                    ["wii", "place", "--samples", "1000000000"], ["reproduce", "--only", "R2", "-o", "r", "--quiet"],
                    ["run", "small.lua", "-o", "fine.h5", "--set", "voxelsize=0.0002"],
                    ["wii", "serve", "--trajectory", "natural", "--port", "0"],
                    ["wii", "listen", "WiiMote0@127.0.0.1:1", "-o", "t.csv", "--patience", "60"]]
        for number, command in [(n, c) for c in commands for n in (SIGNALS if c[0] == "replay" else SIGNALS[:1])]:
            with self.subTest(command=command, signal=number.name):
                process = self.start(*command)
                self.wait_until_caught(number, process)
                time.sleep(0.15)
                self.assertIsNone(process.poll(), "is not long: this would prove nothing")
                self.interrupt(process, number)
        self.assertNotIn("fine.h5", os.listdir(self.folder))

    def test_nohup_is_kept_to(self):
        process = self.start("run", "small.lua", "-o", "a.h5", "--duration", "600", "--realtime",
                             preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN))
        self.wait_for("a.h5", process)
        process.send_signal(signal.SIGHUP)
        time.sleep(0.2)
        self.assertIsNone(process.poll())
        self.interrupt(process, signal.SIGTERM)


if __name__ == "__main__":
    unittest.main()
