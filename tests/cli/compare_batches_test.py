"""`verisim compare` of two batch folders, read as INTERFACES section 5 describes them."""
import json
import os
import random
import unittest

from compare_test import Compare

BATCH = {"format": "verisim-batch", "format_version": 1, "version": "0.1.0", "commit": "abc", "scenario": "/x/peg.lua",
         "scenario_sha256": "00", "seed": 1, "runs": 4}
INDEX = """run,seed,clearance,word,status,error,outcome,depth,frames,collision_frames,max_force_N,max_penetration_m,end,state_hash,cost.points_tested,cost.contacts
0,11,0.005,a,done,,inserted,0.2,1000,500,3,0.001,done,aa,5000,700
1,12,0.005,a,done,,inserted,0.2,1000,510,3.5,0.0011,done,bb,5100,710
2,11,0.001,"a,b",done,,stuck,0.1,1000,900,9,0.002,done,cc,9000,1400
3,12,0.001,"a,b",diverged,"not finite, here",,,300,200,,,diverged,dd,900,140
"""
TIMING = "run,process_s,load_s,wall_s,frame_ns.p50\n" + "".join(f"{run},0.{run + 3},0.2,0.1,9000\n" for run in range(4))


class Batches(Compare):
    def batch(self, name, index=INDEX, timing=TIMING, **manifest):
        os.makedirs(self.path(name), exist_ok=True)
        self.write(name + "/batch.json", json.dumps({**BATCH, **manifest}))
        self.write(name + "/index.csv", index)
        if timing is not None:
            self.write(name + "/timing.csv", timing)
        return self.path(name)

    def test_the_same_batch_is_the_same(self):
        report = self.compare(self.batch("a"), self.batch("b"), code=0)
        self.assertEqual((report["verdict"], report["counts"], report["only_a"]), ("same", [], []))
        words = {o["name"]: (o["a"], o["b"]) for o in report["outcomes"]}
        self.assertEqual(words["outcome 'inserted'"], (2, 2))
        self.assertEqual(words["status 'diverged'"], (1, 1))
        accuracy = {f["name"]: f for f in report["accuracy"]}
        self.assertAlmostEqual(accuracy["max_force_N"]["a"], (3 + 3.5 + 9) / 3)
        self.assertEqual(accuracy["depth"]["b"], (0.2 + 0.2 + 0.1) / 3)
        self.assertIn("4 runs are in both", " ".join(report["notes"]))

    def test_runs_are_paired_by_parameters_and_seed_in_whatever_order(self):
        rows = INDEX.strip().split("\n")
        turned = [rows[0]] + [f"{i},{row.split(',', 1)[1]}" for i, row in enumerate(reversed(rows[1:]))]
        report = self.compare(self.batch("a"), self.batch("b", "\n".join(turned) + "\n"), code=0)
        self.assertEqual(report["verdict"], "same")

    def test_counts_are_sums_and_tell_in_how_many_runs(self):
        report = self.compare(self.batch("a"), self.batch("b", INDEX.replace(",5100,", ",5101,")), code=1)
        self.assertEqual(report["verdict"], "worse")
        (count,) = report["counts"]
        self.assertEqual((count["name"], count["a"], count["b"]), ("cost.points_tested", 20000, 20001))
        self.assertEqual(count["note"], "in 1 of 4 runs")
        report = self.compare(self.batch("a"), self.batch("b", INDEX.replace(",5100,", ",5101,").replace(",5000,", ",4999,")), code=1)
        self.assertEqual(report["verdict"], "different")  # the same sum, of other runs

    def test_flips_of_outcomes_are_counted(self):
        flipped = INDEX.replace("0,11,0.005,a,done,,inserted", "0,11,0.005,a,done,,stuck").replace(
            "2,11,0.001,\"a,b\",done,,stuck", "2,11,0.001,\"a,b\",done,,inserted")
        report = self.compare(self.batch("a"), self.batch("b", flipped), code=1)
        self.assertEqual(report["verdict"], "different")
        flips = {o["name"]: o["b"] for o in report["outcomes"] if "became" in o["name"]}
        self.assertEqual(flips, {"outcome 'inserted' became 'stuck'": 1, "outcome 'stuck' became 'inserted'": 1})

    def test_a_run_that_failed_is_worse(self):
        report = self.compare(self.batch("a"), self.batch("b", INDEX.replace('1,12,0.005,a,done,,', '1,12,0.005,a,timeout,late,')), code=1)
        self.assertEqual(report["verdict"], "worse")
        self.assertEqual(self.compare(self.batch("b"), self.batch("a"), code=0)["verdict"], "same")

    def test_what_only_one_of_them_has_is_listed(self):
        less = "\n".join(INDEX.strip().split("\n")[:-1]) + "\n"
        report = self.compare(self.batch("a"), self.batch("b", less), code=1)
        self.assertEqual((report["verdict"], report["only_a"]), ("different", ["run 3"]))
        other = INDEX.replace("3,12,", "3,13,")
        report = self.compare(self.batch("a"), self.batch("b", other), code=1)
        self.assertEqual((report["only_a"], report["only_b"]), (["run 3"], ["run 3"]))
        report = self.compare(self.batch("a"), self.batch("b", INDEX.replace("depth", "way")), code=1)
        self.assertEqual((report["only_a"], report["only_b"]), (["column depth"], ["column way"]))

    def test_runs_of_other_durations_are_told(self):
        longer = INDEX.replace(",frames,", ",simulated_s,frames,").replace("0.2,1000,", "0.2,1,1000,").replace("0.1,1000,", "0.1,1,1000,")
        longer = longer.replace(",,300,", ",,0.3,300,")
        report = self.compare(self.batch("a", longer), self.batch("b", longer.replace("0.2,1,", "0.2,2,")), code=0)
        self.assertTrue([n for n in report["notes"] if n.startswith("2 of 4 runs simulate another time in B")], report["notes"])
        report = self.compare(self.batch("a"), self.batch("b"), code=0)
        self.assertFalse([n for n in report["notes"] if "another time" in n])

    def test_another_text_of_the_scenario_is_told(self):
        other = self.compare(self.batch("a"), self.batch("b", scenario_sha256="11"), code=0)
        self.assertIn("the text of the scenario is not the same", other["notes"])
        same = self.compare(self.batch("a"), self.batch("c"), code=0)
        self.assertNotIn("the text of the scenario is not the same", same["notes"])

    def test_times_are_paired_and_judged_by_a_wide_bound(self):
        rows = 30
        index = INDEX.split("\n")[0] + "\n" + "".join(
            f"{i},{i},0.005,a,done,,inserted,0.2,1000,500,3,0.001,done,aa,5000,700\n" for i in range(rows))
        draw = random.Random(5)
        def timing(factor):
            return "run,process_s,wall_s\n" + "".join(
                f"{i},{(1 + i) * factor * (1 + 0.01 * draw.random()):.6f},0.1\n" for i in range(rows))
        for factor, verdict, code in [(1.5, "same", 0), (3, "worse", 1), (1 / 3, "better", 0)]:
            report = self.compare(self.batch("a", index, timing(1)), self.batch("b", index, timing(factor)), code=code)
            self.assertEqual(report["verdict"], verdict, factor)
            (time,) = [t for t in report["times"] if t["name"] == "process_s"]
            self.assertAlmostEqual(time["ratio"] / factor, 1, delta=0.01)  # of pairs: runs of 1 to 30 s

    def timing(self, conditions, slower=1, rows=30, columns="jobs,cache,cpu"):
        """Of `rows` runs; conditions: of each run a text for these columns, or one for all."""
        draw = random.Random(7)
        each = [conditions] * rows if isinstance(conditions, str) else conditions
        return f"run,process_s,wall_s,{columns}\n" + "".join(
            f"{i},{(1 + i) * slower * (1 + 0.01 * draw.random()):.6f},0.1,{each[i]}\n" for i in range(rows))

    def test_times_under_other_conditions_are_no_verdict(self):
        rows = 30
        index = INDEX.split("\n")[0] + "\n" + "".join(
            f"{i},{i},0.005,a,done,,inserted,0.2,1000,500,3,0.001,done,aa,5000,700\n" for i in range(rows))
        a = self.batch("a", index, self.timing("1,warm,x"))
        for conditions, words in (("2,warm,x", "jobs 1 and 2"), ("1,off,x", "cache warm and off"), ("1,warm,y", "cpu x and y"),
                                  ("4,cold,y", "jobs 1 and 4; cache warm and cold; cpu x and y"), ("1,,x", "cache warm and not told")):
            report = self.compare(a, self.batch("b", index, self.timing(conditions, slower=3)), code=0)
            self.assertEqual(report["verdict"], "same", conditions)
            self.assertIn("times not comparable: " + words, report["notes"])
            self.assertEqual({t["note"] for t in report["times"]}, {"not comparable: " + words})
            self.assertAlmostEqual(next(t["ratio"] for t in report["times"] if t["name"] == "process_s"), 3, delta=0.1)
        # Counts and outcomes are compared all the same.
        report = self.compare(a, self.batch("b", index.replace(",5000,", ",5001,"), self.timing("2,warm,x", slower=3)), code=1)
        self.assertEqual((report["verdict"], report["why"]), ("worse", ["cost.points_tested is higher"]))

    def test_runs_under_the_same_conditions_are_judged_without_the_others(self):
        rows = 30
        index = INDEX.split("\n")[0] + "\n" + "".join(
            f"{i},{i},0.005,a,done,,inserted,0.2,1000,500,3,0.001,done,aa,5000,700\n" for i in range(rows))
        mixed = ["1,cold,x"] * 3 + ["1,warm,x"] * (rows - 3)
        report = self.compare(self.batch("a", index, self.timing(mixed)),
                              self.batch("b", index, self.timing("1,warm,x", slower=3)), code=1)
        self.assertEqual(report["verdict"], "worse")
        self.assertIn("times of 3 of 30 runs not comparable, and left out: cache cold and warm in 3 of 30 runs", report["notes"])
        self.assertEqual(next(t["repetitions"] for t in report["times"] if t["name"] == "process_s"), [27, 27])

    def test_what_does_not_tell_its_conditions_is_said(self):
        report = self.compare(self.batch("a"), self.batch("b"), code=0)
        self.assertTrue([n for n in report["notes"] if n.startswith("not told by both: with how many jobs")], report["notes"])

    def test_a_broken_batch_json_is_told_with_its_line(self):
        a = self.batch("a")
        b = self.batch("b")
        self.write("b/batch.json", '{\n "format": "verisim-batch",\n "runs" 4\n}')
        self.refuse(3, ["b/batch.json:3: is no JSON", "make the batch again"], "compare", a, b)

    def test_what_is_no_batch_is_refused(self):
        a = self.batch("a")
        self.refuse(3, "batch.json", "compare", a, self.folder)
        self.refuse(3, ["peg.lua", "slide.lua", "same scenario"], "compare", a, self.batch("b", scenario="/y/slide.lua"))
        self.refuse(3, "has no runs: there is nothing to compare", "compare", a, self.batch("e", INDEX.split("\n")[0] + "\n"))
        self.refuse(3, "format 2", "compare", a, self.batch("c", format_version=2))
        self.refuse(3, "verisim batch", "compare", a, self.batch("d", format="another"))
        self.refuse(3, "index.csv:3", "compare", a, self.batch("e", INDEX.replace("1,12,0.005,a,", "1,12,0.005,")))
        self.refuse(3, "no runs", "compare", a, self.batch("f", INDEX.split("\n")[0] + "\n"))
        self.refuse(3, "'run'", "compare", a, self.batch("g", ""))
        self.refuse(3, "quote", "compare", a, self.batch("h", INDEX.replace('"not finite, here"', '"not finite, here')))
        for i, time in enumerate(("nan", "inf", "-1", "fast")):
            self.refuse(3, ["timing.csv:3", time], "compare", a, self.batch(f"t{i}", timing=TIMING.replace("0.4", time)))
        os.remove(os.path.join(a, "index.csv"))
        self.refuse(3, ["index.csv", "not ended"], "compare", self.batch("i"), a)
        self.assertEqual(self.compare(self.batch("a", timing=TIMING), self.batch("j", timing=None), code=0)["times"], [])


if __name__ == "__main__":
    unittest.main()
