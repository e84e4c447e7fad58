"""`verisim compare --programs`: two builds in turns; how often compare errs; the counts that CI compares.

VERISIM_LONG_TESTS=1 compares identical programs 300 times, and one that is slower by 5 % 30 times, for real: two hours.
VERISIM_COMPARISONS=0-60 does a part of it (of these seeds, and a tenth as many): the parts of several days add up.
"""
import json
import os
import subprocess
import sys
import unittest

from compare_test import Compare
from program import ProgramTest, SMALL, SOURCE, VERISIM

COMPARISONS = os.environ.get("VERISIM_COMPARISONS", "0-300" if os.environ.get("VERISIM_LONG_TESTS") else "")
SLOWED = os.path.join(os.path.dirname(VERISIM), "tests", "slowed")


class Programs(Compare):
    def programs(self, *arguments, a=VERISIM, b=VERISIM, runs=2, code=0):
        done = self.run_program("compare", "--programs", a, b, "--runs", runs, "--json", "--", *arguments, timeout=3600)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return json.loads(done.stdout)

    def slowed(self, name, fraction):
        script = self.write(name, f'#!/bin/sh\nexec "{SLOWED}" {fraction} "{VERISIM}" "$@"\n')
        os.chmod(script, 0o755)
        return script

    def test_runs_are_compared_and_timed_in_turns(self):
        scenario = self.write("small.lua", SMALL)
        times = self.path("times.csv")
        done = self.succeed("compare", "--programs", VERISIM, VERISIM, "--runs", "4", "-o", times, "--json", "--", "run", scenario)
        report = json.loads(done.stdout)
        self.assertEqual((report["verdict"], report["counts"]), ("same", []))
        self.assertRegex(report["why"][0], "process_s.* without a verdict: too few runs")
        self.assertIn("state_hash", {f["name"] for f in report["accuracy"]})
        self.assertLessEqual({"process_s", "cpu_s", "load_s", "wall_s", "frame_ns.p50"}, {t["name"] for t in report["times"]})
        for time in report["times"]:
            self.assertEqual(time["repetitions"], [4, 4])
            self.assertIn("too few", time["note"])
        with open(times) as f:
            rows = [line.strip().split(",") for line in f]
        self.assertEqual(rows[0][:3], ["pair", "program", "process_s"])
        for pair in range(4):
            self.assertEqual(sorted(row[1] for row in rows[1:] if row[0] == str(pair)), ["A", "B"])
        self.assertFalse(os.path.exists(self.path("runs")), "the runs' own files are not left behind")

    def test_a_program_that_takes_half_as_long_again_is_slower(self):
        fast, slow = self.slowed("fast", 0), self.slowed("slow", 0.5)
        report = self.programs("trace", "synth", "reach", "-o", self.path("r.csv"), a=fast, b=slow, runs=40, code=1)
        self.assertEqual(report["verdict"], "worse")
        (cpu,) = [t for t in report["times"] if t["name"] == "cpu_s"]
        self.assertEqual(cpu["change"], "slower")
        self.assertLess(cpu["low"], 1.5)
        self.assertGreater(cpu["high"], 1.3)  # the shell and the program that slows are in both

    def test_programs_that_cannot_run_are_refused(self):
        scenario = self.write("small.lua", SMALL)
        self.refuse(3, ["none", "cannot be started"], "compare", "--programs", VERISIM, self.path("none"), "--", "run", scenario)
        self.refuse(3, ["ended with 3", "missing.lua"], "compare", "--programs", VERISIM, VERISIM, "--", "run", "missing.lua")
        self.refuse(3, "/bin/true: ended with 0 and wrote no run file", "compare", "--programs", VERISIM, "/bin/true", "--", "run", scenario)
        for words in (["--"], ["--runs", "1", "--"]):  # what stands behind -- is the programs', in either case
            self.refuse(2, "ARGS have -o", "compare", "--programs", VERISIM, VERISIM, *words, "run", scenario, "-o", "x.h5")
            self.assertFalse(os.path.exists(self.path("x.h5")))
        self.refuse(2, "--runs", "compare", "--runs", "5", scenario, scenario)
        self.refuse(2, "--help", "compare", "--programs", VERISIM, VERISIM, "--runs", "0", "--", "run", scenario)
        self.refuse(2, "a batch that is done", "compare", "--programs", VERISIM, VERISIM, "--", "batch", scenario)

    def test_o_replaces_nothing_but_times_and_looks_first(self):
        precious = self.write("precious.txt", "mine")
        for place in (precious, VERISIM, self.folder):
            self.refuse(5, os.path.basename(place), "compare", "--programs", VERISIM, VERISIM, "--runs", "1", "-o", place, "--", "doctor")
        with open(precious) as f:
            self.assertEqual(f.read(), "mine")

    def test_rates_are_printed_and_kept(self):
        times = self.path("times.csv")
        with open(os.path.join(SOURCE, "bench", "baseline", "times.csv")) as f:
            lines = f.readlines()
        with open(times, "w") as f:
            f.writelines(lines[:100])
        self.refuse(3, "800", "compare", "--self-test", times)
        self.refuse(3, "times.csv:5", "compare", "--self-test", self.write("times.csv", "process_s\n1\n1\n1\nnan\n"))

    @unittest.skipUnless(COMPARISONS, "long: two hours")
    def test_for_real_identical_builds_are_the_same_and_five_percent_are_caught(self):
        alarms, caught = 0, 0
        first, last = map(int, COMPARISONS.split("-"))
        for seed in range(first, last):
            done = self.run_program("compare", "--programs", VERISIM, VERISIM, "--runs", "100", "--seed", seed, "--json",
                                    "--", "trace", "synth", "reach", "-o", self.path("r.csv"))
            alarms += json.loads(done.stdout)["verdict"] != "same"
        a, b = self.slowed("a", 0), self.slowed("b", 0.05)
        scenario = self.write("small.lua", SMALL)
        slower = range(first // 10, last // 10)
        for seed in slower:
            done = self.run_program("compare", "--programs", a, b, "--seed", seed, "--json", "--", "run", scenario,
                                    timeout=3600)
            caught += json.loads(done.stdout)["verdict"] == "worse"
        print(f"\n{alarms} of {last - first} comparisons of identical builds were false alarms, "
              f"{caught} of {len(slower)} slower by 5 % were caught")
        self.assertLess(alarms, 0.01 * (last - first) + 1)
        may_be_missed = 0.05 * len(slower) if len(slower) >= 20 else 1  # of few, one is more than 5 %
        self.assertGreaterEqual(caught, len(slower) - may_be_missed)


class Counts(ProgramTest):
    """bench/baseline/counts.py, which CI calls: what it does when a count is another."""

    def check(self, file, *options):
        counts = os.path.join(SOURCE, "bench", "baseline", "counts.py")
        return subprocess.run([sys.executable, "-B", counts, VERISIM, "--file", file, *options], capture_output=True, text=True)

    def test_a_changed_count_fails_with_the_list_until_the_file_is_updated(self):
        with open(os.path.join(SOURCE, "bench", "baseline", "counts.json")) as f:
            (slide,) = [run for run in json.load(f)["runs"] if run["run"] == "slide.lua"]
        changed = json.loads(json.dumps(slide))
        changed["cost"]["contacts"] -= 5
        changed["cost"]["gone"] = 7
        changed["outcome"] = "stuck"
        file = self.write("counts.json", json.dumps({"runs": [changed]}))
        done = self.check(file)
        self.assertEqual(done.returncode, 1, done.stderr)
        rows = [line.split()[0] for line in done.stdout.splitlines() if line.startswith("  ") and "->" in line]
        self.assertEqual(rows, ["outcome", "contacts", "gone"])
        self.assertIn("--target update_counts", done.stdout)
        self.assertEqual(self.check(file, "--update").returncode, 0)
        with open(file) as f:
            self.assertEqual(json.load(f)["runs"], [slide])
        done = self.check(file)
        self.assertEqual((done.returncode, "every count" in done.stdout), (0, True))

    def test_a_broken_file_is_told_with_its_place(self):
        for text, words in (('{\n"runs": [\n', "counts.json:3: is no JSON"), ("[]", "counts.json: has no list 'runs'"), ('{"runs": 5}', "has no list 'runs'"),
                            ('{"runs": [{"run": 5}]}', "runs[0] is not what this program writes")):
            done = self.check(self.write("counts.json", text))
            self.assertEqual(done.returncode, 1)
            self.assertRegex(done.stderr, r"^error: [^\n]+put the committed file back[^\n]+\n$")
            self.assertIn(words, done.stderr)
        self.assertIn("cannot be read", self.check(self.path("gone.json")).stderr)


if __name__ == "__main__":
    unittest.main()
