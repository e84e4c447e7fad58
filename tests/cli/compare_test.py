"""`verisim compare` (INTERFACES section 5) of runs and of benchmark files, and what it refuses.

Batches: compare_batches_test.py. Builds, and how often compare errs: compare_programs_test.py.
"""
import json
import os
import random
import shutil
import subprocess
import sys
import unittest

import h5py

from program import ProgramTest, SMALL

GOOGLES_COMPARE = "/usr/share/benchmark/compare.py"
KEYS = {"verdict", "counts", "accuracy", "outcomes", "times"}


def why_googles_compare_cannot_run():
    if not os.path.exists(GOOGLES_COMPARE):
        return f"{GOOGLES_COMPARE} is not there (apt install libbenchmark-tools)"
    if subprocess.run([sys.executable, "-c", "import scipy"], capture_output=True).returncode != 0:
        return "Google Benchmark's compare.py needs SciPy (apt install python3-scipy)"
    return None


def benchmark_json(times, aggregates=(), **context):
    """Google Benchmark's output. times: name to list of (real, cpu)."""
    rows = []
    for name, repetitions in times.items():
        for i, (real, cpu) in enumerate(repetitions):
            rows.append({"name": name, "run_name": name, "run_type": "iteration", "repetitions": len(repetitions),
                         "repetition_index": i, "threads": 1, "iterations": 10, "real_time": real, "cpu_time": cpu,
                         "time_unit": "ns"})
    for name, kind, real, cpu in aggregates:
        rows.append({"name": f"{name}_{kind}", "run_name": name, "run_type": "aggregate", "aggregate_name": kind,
                     "repetitions": 9, "threads": 1, "iterations": 9, "real_time": real, "cpu_time": cpu,
                     "time_unit": "ns"})
    return json.dumps({"context": {"date": "now", "num_cpus": 2, **context}, "benchmarks": rows})


def scattered(middle, n, seed, by=0.01):
    draw = random.Random(seed)
    return [(middle * (1 + by * draw.gauss(0, 1)), 0.9 * middle * (1 + by * draw.gauss(0, 1))) for _ in range(n)]


class Compare(ProgramTest):
    def compare(self, a, b, *options, code):
        done = self.run_program("compare", a, b, *options, "--json")
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        report = json.loads(done.stdout)
        self.assertLessEqual(KEYS, set(report))
        return report

    def table(self, *args, code=0):
        done = self.run_program("compare", *args)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done.stdout


class Runs(Compare):
    def run_as(self, name, *args, script=SMALL, scenario="small.lua"):
        run_file = self.path(name)
        self.succeed("run", self.write(scenario, script), "-o", run_file, "--quiet", *args)
        return run_file

    def test_the_same_run_twice_is_the_same(self):
        report = self.compare(self.run_as("a.h5"), self.run_as("b.h5"), code=0)
        self.assertEqual(report["verdict"], "same")
        self.assertEqual(report["counts"], [])
        self.assertGreater(report["counts_compared"], 20)
        self.assertIsNone(report["first_difference"])
        for figure in report["accuracy"]:
            self.assertEqual(figure["a"], figure["b"], figure)
        self.assertIn("state_hash", {figure["name"] for figure in report["accuracy"]})
        for time in report["times"]:  # one of each: shown, never judged
            self.assertEqual((time["low"], time["high"], time["p"], time["change"]), (None, None, None, "no verdict"))
            self.assertIn("one repetition", time["note"])

    def test_another_parameter_is_told_with_counts_accuracy_and_the_first_difference(self):
        a, b = self.run_as("a.h5"), self.run_as("b.h5", "--set", "speed=0.4")
        report = self.compare(a, b, code=1)
        self.assertEqual(report["verdict"], "different")
        with h5py.File(a) as f, h5py.File(b) as g:
            for count in report["counts"]:
                if count["name"].startswith("/cost/"):
                    self.assertEqual(count["a"], int(f[count["name"]][()].sum()), count)
                    self.assertEqual(count["b"], int(g[count["name"]][()].sum()), count)
            differing = [name for name in f["cost"] if f["cost"][name][()].sum() != g["cost"][name][()].sum()]
            self.assertEqual(sorted(c["name"] for c in report["counts"] if c["name"].startswith("/cost/")),
                             sorted("/cost/" + name for name in differing))
            frame = next(i for i in range(300) if any(
                (f["state/body"][body][fact][i] != g["state/body"][body][fact][i]).any()
                for body in f["state/body"] for fact in f["state/body"][body])
                or (f["state/device/hand/handle_pose"][i] != g["state/device/hand/handle_pose"][i]).any())
        self.assertTrue(report["first_difference"].startswith(f"frame {frame}, /state/"), report["first_difference"])
        self.assertIn("parameter speed is 0.5 in A, 0.4 in B", report["notes"])
        self.assertIn("verdict: different", self.table(a, b, code=1))

    def test_more_work_with_the_same_state_is_worse_and_less_is_better(self):
        a, b = self.run_as("a.h5"), self.run_as("b.h5")
        with h5py.File(b, "r+") as f:
            f["cost/contacts"][17] += 3
        report = self.compare(a, b, code=1)
        self.assertEqual(report["verdict"], "worse")
        (count,) = report["counts"]
        self.assertEqual((count["name"], count["b"] - count["a"]), ("/cost/contacts", 3))
        report = self.compare(b, a, code=0)
        self.assertEqual(report["verdict"], "better")

    def test_one_flipped_bit_of_the_state_is_found_where_it_is(self):
        a, b = self.run_as("a.h5"), self.run_as("b.h5")
        with h5py.File(b, "r+") as f:
            pose = f["state/body/box/pose"]
            pose[123, 2] = pose[123, 2] * (1 + 2**-52)
        report = self.compare(a, b, code=1)
        self.assertEqual(report["verdict"], "different")
        self.assertIn("frame 123, /state/body/box/pose[2]:", report["first_difference"])

    def test_less_accurate_is_worse_and_within_the_bound_is_said(self):
        a, b = self.run_as("a.h5"), self.run_as("b.h5")
        for factor, verdict, code in [(1.5, "worse", 1), (0.5, "better", 0), (1.001, "same", 0)]:
            with h5py.File(b, "r+") as f:
                summary = json.loads(f["summary"].attrs["json"])
                summary["max_penetration_m"] = 1e-4 * factor
                f["summary"].attrs["json"] = json.dumps(summary)
            with h5py.File(a, "r+") as f:
                summary = json.loads(f["summary"].attrs["json"])
                summary["max_penetration_m"] = 1e-4
                f["summary"].attrs["json"] = json.dumps(summary)
            report = self.compare(a, b, code=code)
            self.assertEqual(report["verdict"], verdict, factor)
            (figure,) = [f for f in report["accuracy"] if f["name"] == "max_penetration_m"]
            self.assertAlmostEqual(figure["bound"], 1e-6)

    def test_what_only_one_of_them_recorded_is_listed(self):
        more = SMALL.replace('addDevice(hand)', 'addObject{ name = "lamp", position = {0, 0, 1}, Solid.sphere{radius = 0.01} }\naddDevice(hand)')
        report = self.compare(self.run_as("a.h5"), self.run_as("b.h5", script=more), code=1)
        self.assertEqual(report["verdict"], "different")
        self.assertIn("/state/body/lamp/pose", report["only_b"])
        self.assertIn("the text of the scenario is not the same", report["notes"])

    def test_a_killed_run_is_told_from_one_that_ended(self):
        a, b = self.run_as("a.h5"), self.run_as("b.h5")
        with h5py.File(b, "r+") as f:
            for name in list(f["summary"].attrs):
                del f["summary"].attrs[name]
        report = self.compare(a, b, code=1)
        self.assertEqual([o for o in report["outcomes"] if o["name"] == "end"][0]["b"], "killed")
        self.assertEqual(report["verdict"], "worse")

    def test_runs_that_are_not_comparable_or_no_runs_are_refused(self):
        a = self.run_as("a.h5")
        other = self.run_as("other.h5", scenario="large.lua")
        self.refuse(3, ["small.lua", "large.lua", "same scenario"], "compare", a, other)
        self.refuse(3, "none.h5", "compare", a, self.path("none.h5"))
        self.refuse(3, "text.h5", "compare", a, self.write("text.h5", "no run"))
        self.refuse(3, ["a run file", "JSON of benchmarks"], "compare", a, self.write("b.json", "{}"))
        self.refuse(2, "--help", "compare", a)
        self.refuse(2, "--help", "compare", a, a, a)
        later = self.path("later.h5")
        shutil.copy(a, later)
        with h5py.File(later, "r+") as f:
            f.attrs["format_version"] = 99
        self.refuse(3, "99", "compare", a, later)

    def test_history_shows_a_figure_over_versions(self):
        folder = self.path("history")
        os.mkdir(folder)
        for i, speed in enumerate((0.5, 0.5, 0.4)):
            self.run_as(f"history/{i}.h5", "--set", f"speed={speed}")
        with open(os.path.join(folder, "notes.txt"), "w") as f:
            f.write("passed over")
        done = self.succeed("compare", "--history", folder, "--figure", "/cost/contacts", "--json")
        (figure,) = json.loads(done.stdout)["history"]
        self.assertEqual(figure["figure"], "/cost/contacts")
        self.assertEqual([row["file"] for row in figure["rows"]], ["0.h5", "1.h5", "2.h5"])
        self.assertEqual([row["change"] for row in figure["rows"][:2]], [None, 0])
        self.assertLess(figure["rows"][2]["change"], 0)
        with h5py.File(os.path.join(folder, "2.h5")) as f:
            self.assertEqual(figure["rows"][2]["value"], int(f["cost/contacts"][()].sum()))
            self.assertEqual(figure["rows"][2]["commit"], f.attrs["commit"])
        self.assertIn("max_force_N", self.succeed("compare", "--history", folder).stdout)
        self.refuse(3, "max_force_N", "compare", "--history", folder, "--figure", "max_force")
        self.refuse(3, "no folder", "compare", "--history", self.path("none"))
        self.refuse(2, "--figure", "compare", "--figure", "wall_s")
        self.run_as("history/3.h5", scenario="large.lua")
        self.refuse(3, ["small.lua", "large.lua"], "compare", "--history", folder)


class Benchmarks(Compare):
    def files(self, a, b):
        return self.write("a.json", a), self.write("b.json", b)

    def test_slower_faster_and_the_same_are_told(self):
        base = {"BM_one": scattered(100, 20, 1), "BM_two/real_time": scattered(5000, 20, 2)}
        for factor, verdict, code in [(1.05, "worse", 1), (1 / 1.05, "better", 0), (1, "same", 0)]:
            other = {"BM_one": scattered(100 * factor, 20, 3), "BM_two/real_time": scattered(5000, 20, 4)}
            report = self.compare(*self.files(benchmark_json(base), benchmark_json(other)), code=code)
            self.assertEqual(report["verdict"], verdict, factor)
            (time,) = [t for t in report["times"] if t["name"] == "BM_one"]
            self.assertAlmostEqual(time["ratio"], factor, delta=0.01)
            self.assertLessEqual(time["low"], time["ratio"])
            self.assertLessEqual(time["ratio"], time["high"])

    def test_cpu_time_counts_but_where_the_name_says_real_time(self):
        for name, judged in [("BM_x", 1), ("BM_x/real_time", 0), ("BM_x/manual_time", 0)]:
            for slower in (0, 1):
                a, b = scattered(100, 20, 1), [list(times) for times in scattered(100, 20, 2)]
                for times in b:
                    times[slower] *= 1.2
                report = self.compare(*self.files(benchmark_json({name: a}), benchmark_json({name: b})),
                                      code=1 if slower == judged else 0)
                self.assertEqual(report["verdict"], "worse" if slower == judged else "same", (name, slower))

    def test_benchmarks_of_one_file_are_listed(self):
        a, b = self.files(benchmark_json({"BM_old": scattered(1, 9, 1), "BM_both": scattered(2, 9, 2)}),
                          benchmark_json({"BM_both": scattered(2, 9, 2), "BM_new": scattered(3, 9, 3)}))
        report = self.compare(a, b, code=1)
        self.assertEqual((report["verdict"], report["only_a"], report["only_b"]), ("different", ["BM_old"], ["BM_new"]))
        text = self.table(a, b, code=1)
        self.assertIn("only in A: BM_old", text)
        self.assertIn("only in B: BM_new", text)

    def test_counters_that_do_not_scatter_are_counts(self):
        def with_counters(contacts, times):
            report = json.loads(benchmark_json({"BM": scattered(1, 9, 1)}))
            for entry, time in zip(report["benchmarks"], times):
                entry["contacts"], entry["best_us"] = contacts, time
            return json.dumps(report)
        same = self.compare(*self.files(with_counters(5, range(9)), with_counters(5, range(1, 10))), code=0)
        self.assertEqual((same["verdict"], same["counts"]), ("same", []))
        other = self.compare(*self.files(with_counters(5, range(9)), with_counters(6, range(9))), code=1)
        self.assertEqual((other["verdict"], [c["name"] for c in other["counts"]]), ("different", ["BM contacts"]))
        gone = self.compare(*self.files(with_counters(5, range(9)), benchmark_json({"BM": scattered(1, 9, 1)})), code=1)
        self.assertEqual(gone["only_a"], ["BM best_us", "BM contacts"])

    def test_one_repetition_is_no_verdict(self):
        a, b = self.files(benchmark_json({"BM": scattered(1, 1, 1)}), benchmark_json({"BM": scattered(9, 1, 1)}))
        report = self.compare(a, b, code=0)
        self.assertEqual(report["verdict"], "same")
        self.assertIn("one repetition", report["times"][0]["note"])
        few = self.compare(*self.files(benchmark_json({"BM": scattered(1, 3, 1)}), benchmark_json({"BM": scattered(9, 3, 1)})), code=0)
        self.assertIn("too few", [t for t in few["times"] if t["name"] == "BM"][0]["note"])

    def test_another_machine_is_told(self):
        a, b = self.files(benchmark_json({"BM": scattered(1, 9, 1)}, cpu="one", commit="aaa"),
                          benchmark_json({"BM": scattered(1, 9, 1)}, cpu="other", commit="bbb"))
        report = self.compare(a, b, code=0)
        self.assertIn("cpu is one in A, other in B", report["notes"])
        self.assertEqual((report["a"]["commit"], report["b"]["commit"]), ("aaa", "bbb"))

    def test_times_of_another_machine_are_no_verdict(self):
        for key in ("cpu", "governor", "num_cpus"):
            a, b = self.files(benchmark_json({"BM": scattered(1, 20, 1)}, **{key: "one"}),
                              benchmark_json({"BM": scattered(3, 20, 1)}, **{key: "other"}))
            report = self.compare(a, b, code=0)
            self.assertEqual(report["verdict"], "same")
            self.assertIn(f"times not comparable: {key} one and other", report["notes"])
            self.assertEqual({t["note"] for t in report["times"]}, {f"not comparable: {key} one and other"})
        a, b = self.files(benchmark_json({"BM": scattered(1, 20, 1)}, compiler="one"),
                          benchmark_json({"BM": scattered(3, 20, 1)}, compiler="other"))
        self.assertEqual(self.compare(a, b, code=1)["verdict"], "worse", "another compiler is what may be compared")

    def test_broken_json_is_told_with_its_line(self):
        a, b = self.files(benchmark_json({"BM": scattered(1, 9, 1)}), '{\n "benchmarks": [\n  {"name": }\n ]\n}')
        self.refuse(3, ["b.json:3: is no JSON", "--benchmark_out"], "compare", a, b)

    def test_columns_line_up(self):
        a, b = self.files(benchmark_json({"BM_short": scattered(1, 9, 1), "BM_very_long_name": scattered(1e7, 9, 2)}),
                          benchmark_json({"BM_short": scattered(1, 9, 3), "BM_very_long_name": scattered(1e7, 9, 4)}))
        rows = [line for line in self.table(a, b).splitlines() if line.startswith("  ")]
        end = rows[0].index(" B / A") + len(" B / A")
        for row in rows[1:]:
            self.assertRegex(row[:end], r" \d\.\d{4}$", row)

    def test_what_is_no_benchmark_file_is_refused(self):
        good = self.write("good.json", benchmark_json({"BM": scattered(1, 9, 1)}))
        broken = {
            "cut.json": benchmark_json({"BM": scattered(1, 9, 1)})[:-30],
            "list.json": '{"rows": []}',
            "empty.json": benchmark_json({}),
            "aggregates.json": benchmark_json({}, [("BM", "mean", 1, 1)]),
            "nan.json": benchmark_json({"BM": [(float("nan"), 1)]}),
            "zero.json": benchmark_json({"BM": [(0, 1)]}),
            "text.json": benchmark_json({"BM": [("1", 1)]}),
            "unit.json": benchmark_json({"BM": [(1, 1)]}).replace('"ns"', '"hours"'),
            "failed.json": benchmark_json({"BM": [(1, 1)]}).replace('"threads"', '"error_occurred": true, "threads"'),
            "strange.json": '{"benchmarks": [{"name": "BM", "run_name": 7}]}',
        }
        words = {"nan.json": "NaN", "zero.json": "BM", "aggregates.json": "repetitions", "unit.json": "hours"}
        for name, text in broken.items():
            self.refuse(3, [name, words.get(name, "")], "compare", good, self.write(name, text))
            self.refuse(3, [name, words.get(name, "")], "compare", self.path(name), good)
        self.refuse(3, "nothing.json", "compare", good, self.write("nothing.json", ""))

    @unittest.skipIf(why_googles_compare_cannot_run(), why_googles_compare_cannot_run())
    def test_ratios_and_p_are_those_of_googles_compare(self):
        def median(values):
            values = sorted(values)
            n = len(values)
            return values[n // 2] if n % 2 else (values[n // 2 - 1] + values[n // 2]) / 2
        draw = random.Random(2024)
        times, aggregates = ({}, {}), ([], [])
        for name, n, factor in [("BM_exact", (7, 9), 1.02), ("BM_large", (25, 30), 1.04), ("BM_ties", (12, 12), 1), ("BM_even", (10, 10), 0.5)]:
            for side in (0, 1):
                scale = 1000 * (factor if side else 1)
                rows = [(scale * draw.lognormvariate(0, 0.05), scale * draw.lognormvariate(0, 0.05)) for _ in range(n[side])]
                if name == "BM_ties":
                    rows = [(round(real, -1), round(cpu, -1)) for real, cpu in rows]
                times[side][name] = rows
                aggregates[side].append((name, "median", median([r for r, _ in rows]), median([c for _, c in rows])))
        a, b = self.files(*(benchmark_json(times[side], aggregates[side]) for side in (0, 1)))
        dump = self.path("google.json")
        done = subprocess.run([sys.executable, GOOGLES_COMPARE, "--no-color", "-d", dump, "benchmarks", a, b],
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(dump) as f:
            google = {row["name"]: row for row in json.load(f)}
        ours = {t["name"]: t for t in json.loads(self.run_program("compare", a, b, "--json").stdout)["times"]}
        for name in times[0]:
            cpu, real, theirs = ours[name], ours[name + " (real time)"], google[name]["utest"]
            self.assertAlmostEqual(cpu["p"], theirs["cpu_pvalue"], delta=1e-12 + 1e-9 * theirs["cpu_pvalue"])
            self.assertAlmostEqual(real["p"], theirs["time_pvalue"], delta=1e-12 + 1e-9 * theirs["time_pvalue"])
            (medians,) = google[name + "_median"]["measurements"]
            self.assertAlmostEqual(cpu["b"] / cpu["a"] - 1, medians["cpu"], places=9)
            self.assertAlmostEqual(real["b"] / real["a"] - 1, medians["time"], places=9)


if __name__ == "__main__":
    unittest.main()
