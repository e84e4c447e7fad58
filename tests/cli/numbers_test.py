"""Numbers of the command line: seeds of 64 bits, durations that a run can have, and what is said when memory ends."""
import json
import os
import resource
import shutil
import unittest

import h5py

from program import ProgramTest, SMALL

SEEDED = [["run", "small.lua", "--quiet", "-o", "a.h5"], ["trace", "synth", "hand", "-o", "t.csv"],
          ["wii", "validate"], ["wii", "place"], ["wii", "serve", "--trajectory", "static", "--port", "0"]]
MAX = 2**64 - 1


class Numbers(ProgramTest):
    def setUp(self):
        super().setUp()
        self.write("small.lua", SMALL)

    def test_seeds_that_are_none(self):
        for command in SEEDED:
            for seed in ("-1", "1e3", str(MAX + 1), "0x10", " 5", "5 ", "+5", "", "5.0", "١", "nan", "5u", "1" * 400):
                with self.subTest(command=command, seed=seed):
                    self.refuse(2, [f"--seed {seed}", str(MAX), "decimal"], *command, "--seed", seed)

    def test_the_whole_range_of_seeds(self):
        script = SMALL.replace('name = "hand",', 'name = "hand", tremor = 0.001,')
        hashes = set()
        for seed in (0, 1, 2**53 + 1, 2**63 - 1, 2**63, MAX):
            run_file, summary = self.small_run("--seed", str(seed), script=script)
            hashes.add(summary["state_hash"])
            with h5py.File(run_file) as f:
                self.assertEqual(int(f.attrs["seed"]), seed)
                self.assertEqual(json.loads(f.attrs["invocation"])["seed"], seed)
            self.succeed("replay", run_file, "--verify")
        self.assertEqual(len(hashes), 6)

    def test_lengths_beyond_all_measure(self):
        for size in ("1e13", "1e200", "1e308"):
            self.refuse(3, ["voxelsize is", "usual"], "run", "small.lua", "-o", "a.h5", "--set", "voxelsize=" + size)

    def test_durations_that_are_none(self):
        for command in (["run", "small.lua", "-o", "a.h5"], ["wii", "serve", "--trajectory", "static", "--port", "0"],
                        ["wii", "listen", "W@127.0.0.1:1", "-o", "t.csv"]):
            for duration in ("0", "-1", "nan", "inf", "-inf", "1e400", "1e-400", "x", "", "1s"):
                with self.subTest(command=command, duration=duration):
                    self.refuse(2, ["--duration", duration], *command, "--duration", duration)
        self.refuse(2, "--patience", "wii", "listen", "W@127.0.0.1:1", "-o", "t.csv", "--patience", "nan")

    def refuse_duration(self, duration, words, code=2, code_of_scenario=3):
        self.refuse(code, words, "run", "small.lua", "-o", "a.h5", "--duration", duration)
        self.refuse(code_of_scenario, words, "run", "small.lua", "-o", "a.h5", "--set", f"duration={duration}")
        self.assertEqual(os.listdir(self.folder), ["small.lua"])

    def test_durations_shorter_than_a_frame(self):
        for duration in ("0.0004", "1e-300"):
            self.refuse_duration(duration, [duration, "one frame of 0.001 s"])

    def test_durations_that_nobody_can_wait_for(self):
        for duration in ("1000001", "100000000000000", "1e+300"):
            self.refuse_duration(duration, [duration, "frames", "1000000000"])

    def test_durations_that_the_disk_has_no_room_for(self):
        free = shutil.disk_usage(self.folder).free
        frames = min(free // 100, 1_000_000_000)  # 100 bytes a frame: fewer than any run needs
        if frames * 500 < free:
            self.skipTest(f"{free} bytes are free: the longest run has room here")
        self.refuse_duration(str(frames // 1000), [str(frames // 1000), "GB are free"], 5, 5)

    def test_traces_of_absurd_length(self):
        for duration in ("1e300", "1e12", "0"):
            self.refuse(2, "duration", "trace", "synth", "sine", "-o", "t.csv", "--set", f"duration={duration}")

    @unittest.skipIf(os.environ.get("VERISIM_SANITIZE"), "a sanitizer's shadow is larger than any limit")
    def test_out_of_memory_says_what_wanted_how_much(self):
        def limit():
            resource.setrlimit(resource.RLIMIT_AS, (300_000_000, 300_000_000))
        for command, words in ((["wii", "place", "--count", "100000000"], ["wii place", "MB"]),
                               (["trace", "synth", "sine", "-o", "t.csv", "--set", "duration=20000"], ["trace synth", "GB"]),
                               (["run", "small.lua", "-o", "a.h5", "--duration", "60000"], ["recording 60000000 frames", "MB"])):
            with self.subTest(command=command):
                self.refuse(3, ["out of memory", *words], *command, preexec_fn=limit)


if __name__ == "__main__":
    unittest.main()
