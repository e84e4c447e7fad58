"""A run that ends too early: Ctrl-C, kill -9 at random moments, a full disk, a read-only folder (INTERFACES section 2).
How much of a paced run is missing: killed_in_time_test.py."""
import json
import os
import random
import resource
import signal
import time
import unittest

import h5py

from killable import Killable
from program import SMALL

# Of each kind, paced and free-running; the sanitizers' program is ten times slower.
MOMENTS = int(os.environ.get("VERISIM_KILLS", "50" if os.environ["VERISIM_SANITIZE"] == "" else "10"))


class Killed(Killable):
    def kill_at_random_moments(self, *options):
        clock = random.Random(1)
        for _ in range(MOMENTS):
            process, run_file = self.start(*options)
            time.sleep(clock.uniform(0, 0.4))
            process.kill()
            process.communicate()
            with h5py.File(run_file, "r", swmr=True) as f:  # as it was left
                rows = len(f["/state/time"])
            recovered = self.succeed("recover", run_file)
            self.assertIn("frames kept", recovered.stdout)
            with h5py.File(run_file, "r") as f:
                kept = len(f["/state/time"])
                self.assertLessEqual(abs(kept - rows), 100)
                for path in ["/state/body/box/pose", "/state/hash", "/cost/contacts", "/timing/frame_ns"]:
                    self.assertEqual(len(f[path]), kept, path)
            self.assertIn("nothing to do", self.succeed("recover", run_file).stdout)
        self.succeed("replay", run_file, "--verify")

    def test_killed_at_any_moment_free_running(self):
        self.kill_at_random_moments()

    def test_killed_at_any_moment_paced(self):
        self.kill_at_random_moments("--realtime")

    def test_every_command_recovers_by_itself_and_says_so(self):
        process, run_file = self.start()
        time.sleep(0.3)
        process.kill()
        process.communicate()
        done = self.succeed("replay", run_file, "--verify")
        self.assertIn("killed run", done.stderr)

    def test_a_file_that_is_being_written_is_left_alone(self):
        process, run_file = self.start("--realtime")
        try:
            self.refuse(3, "killed.h5", "recover", run_file)
        finally:
            process.send_signal(signal.SIGINT)
            process.communicate()
        self.succeed("replay", run_file)

    def test_ctrl_c_closes_the_file(self):
        for options in [[], ["--realtime"]]:
            process, run_file = self.start("--json", *options)
            time.sleep(0.3)
            process.send_signal(signal.SIGINT)
            out, _ = process.communicate(timeout=60)
            self.assertEqual(process.returncode, 130)
            summary = json.loads(out)
            with h5py.File(run_file, "r") as f:
                self.assertEqual(len(f["/state/time"]), summary["frames"])
                self.assertEqual(f["/summary"].attrs["end"], "interrupted")
            self.succeed("replay", run_file, "--verify")

    def test_a_full_disk_is_exit_5_and_keeps_what_was_written(self):
        scenario = self.write("small.lua", SMALL)
        run_file = self.path("full.h5")

        def limit():
            resource.setrlimit(resource.RLIMIT_FSIZE, (3_000_000, 3_000_000))
        done = self.run_program("run", scenario, "-o", run_file, "--duration", "60", preexec_fn=limit)
        self.assertEqual(done.returncode, 5, done.stderr)
        self.assertIn("error: ", done.stderr)
        self.assertIn("full.h5", done.stderr)
        with h5py.File(run_file, "r", swmr=True) as f:
            self.assertGreater(len(f["/state/time"]), 0)

    def test_a_place_that_cannot_be_written_is_exit_5(self):
        scenario = self.write("small.lua", SMALL)
        self.write("file", "a file where a folder should be")
        self.refuse(5, "file", "run", scenario, "-o", self.path("file/run.h5"))
        self.refuse(5, "/proc", "run", scenario, "-o", "/proc/run.h5")

    def test_nothing_else_is_left_in_the_folder(self):
        self.small_run()
        self.assertEqual(sorted(os.listdir(self.folder)), ["small.h5", "small.lua"])


if __name__ == "__main__":
    unittest.main()
