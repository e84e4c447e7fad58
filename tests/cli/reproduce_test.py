"""The dissertation's results on the command line (INTERFACES section 1, ORACLES section 1)."""
import csv
import json
import os
import resource
import shutil
import subprocess
import tempfile
import unittest
from xml.etree import ElementTree

import h5py

from program import ProgramTest, VERISIM

KEYS = {"id", "what", "published", "here", "ratio", "why", "runs"}
SANITIZED = os.environ.get("VERISIM_SANITIZE", "") != ""  # ten times slower: without those that take most of the time
LEFT_OUT = ["R1", "R2", "R3", "R5", "R9", "R10", "R11"] if SANITIZED else []
IDS = [f"R{i}" for i in range(1, 12) if f"R{i}" not in LEFT_OUT]


def processor_seconds():
    """What the programs started here have used, on all cores together."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


class Reproduce(ProgramTest):
    """One `reproduce --quick`, looked at from all sides."""

    @classmethod
    def setUpClass(cls):
        cls.shared = tempfile.mkdtemp(prefix="verisim-test-")
        cls.addClassCleanup(shutil.rmtree, cls.shared, ignore_errors=True)
        worked = processor_seconds()
        only = [word for result in IDS for word in ("--only", result)] if SANITIZED else []
        cls.done = subprocess.run([VERISIM, "reproduce", "--quick", "--json", *only], cwd=cls.shared, timeout=600,
                                  capture_output=True, text=True)
        cls.worked = processor_seconds() - worked

    def path(self, name):
        """What the shared command wrote is found beside what this test writes."""
        shared = os.path.join(self.shared, name)
        return shared if os.path.exists(shared) else super().path(name)

    def report(self):
        self.assertEqual(self.done.returncode, 0, self.done.stderr)
        return json.loads(self.done.stdout)

    def rows(self, result):
        return [row for row in self.report()["rows"] if row["id"] == result]

    def files(self, result):
        """Without repetition, in their order."""
        return list(dict.fromkeys(file for row in self.rows(result) for file in row["runs"]))

    def test_quick_measures_every_result_in_time_and_names_its_files(self):
        # The clock would count what other programs take of the machine. Paced parts, which wait, last 8 s.
        self.assertLess(self.worked, 350 if SANITIZED else 35)
        report = self.report()
        self.assertEqual(sorted({row["id"] for row in report["rows"]}), sorted(IDS))
        for row in report["rows"]:
            self.assertLessEqual(KEYS, set(row), row["id"])
            self.assertIn(row["id"], self.done.stderr)
            self.assertTrue(row["why"], f"{row['id']}: a difference without a reason")
            self.assertTrue(row["runs"], f"{row['id']}: a figure from nowhere")
            for file in row["runs"]:
                self.assertTrue(os.path.getsize(self.path(file)), file)
                self.assertIn(file, report["runs"])
            if row["ratio"] is not None:
                self.assertAlmostEqual(row["ratio"], row["here"] / row["published"], places=12)

    def test_r7_count_agrees_with_the_area_and_not_with_the_volume_as_printed(self):
        area, volume = self.rows("R7")
        low, high = area["interval_95"]
        self.assertAlmostEqual(area["published"], 0.637821 * 0.573491, places=6)  # coverage_test's worked number
        self.assertLess(abs(area["here"] - area["published"]), high - low)
        self.assertAlmostEqual(volume["published"], 1.0850727, places=6)
        low, high = volume["interval_95"]
        self.assertGreater(volume["published"] - high, high - low)

    def test_r6_rates_are_those_that_figure_4_6_was_drawn_from(self):
        for row in self.rows("R6"):
            self.assertAlmostEqual(row["ratio"], 1, delta=0.01, msg=row["what"])
        self.assertIn("0.304 m/s", self.rows("R6")[0]["why"])

    def test_r6_figure_4_6_is_drawn_with_a_curve_for_each_law(self):
        (figure,) = [file for file in self.files("R6") if file.endswith(".svg")]
        picture = ElementTree.parse(self.path(figure)).getroot()
        curves = [e.get("d") for e in picture.iter("{http://www.w3.org/2000/svg}path") if e.get("d").count("L") > 100]
        self.assertEqual(len(curves), 3)
        with open(self.path(self.files("R6")[0])) as table:
            rows = list(csv.DictReader(table))
        for curve, law in zip(curves, ("quadratic", "peak_ring", "peak_ring_as_printed")):
            y = [float(point.split()[1]) for point in curve[1:].split("L")]
            rates = [float(row[law]) for row in rows]
            scale = (y[0] - y[-1]) / (rates[-1] - rates[0])  # px a m/s: y is down
            self.assertLess(max(abs(y[0] - at - scale * rate) for at, rate in zip(y, rates)), 0.5, law)

    @unittest.skipIf("R10" in LEFT_OUT, "not measured")
    def test_r10_is_of_the_table_beside_it(self):
        with open(self.path([file for file in self.files("R10") if file.endswith("stickiness.csv")][0])) as table:
            rows = [row for row in csv.DictReader(table) if row["outcome"] == "released"]
        for law in ("cubic", "quadratic", "peak-ring"):
            back = [float(row["way_back_m"]) for row in rows if row["law"] == law]
            moved = [float(row["bubble_moved_m"]) for row in rows if row["law"] == law]
            here = {row["what"]: row["here"] for row in self.rows("R10")}
            self.assertAlmostEqual(here[f"way back, {law}"], sum(back) / len(back), places=12)
            self.assertAlmostEqual(here[f"way back over way of the bubble, {law}"], sum(back) / sum(moved), places=12)
            # What the dissertation observed.
            self.assertAlmostEqual(sum(back) / sum(moved), 1, delta=0.25)
        for file in self.files("R10"):
            if file.endswith(".svg"):
                ElementTree.parse(self.path(file))

    @unittest.skipIf("R1" in LEFT_OUT, "not measured")
    def test_r1_counts_overruns_beside_those_of_an_empty_loop(self):
        share = self.rows("R1")[2]
        self.assertLessEqual(share["interval_95"][0], share["here"])
        self.assertIn("an empty paced loop", share["why"])
        with h5py.File(self.path(self.files("R1")[0])) as run:
            overruns = run["/timing/overrun"][:]
            self.assertAlmostEqual(share["here"], 100 * overruns.mean(), places=9)
            # An empty block between two frames is no long period of either.
            self.assertLess(run["/timing/period_ns"][1:].max(), 0.9e9)

    @unittest.skipIf("R2" in LEFT_OUT, "not measured")
    def test_r2_restored_the_operator_passes_every_two_seconds(self):
        off, restore, ratio = self.rows("R2")
        self.assertEqual([row["published"] for row in (off, restore, ratio)], [3 / 28, 5 / 10, 14 / 3])
        self.assertGreaterEqual(restore["here"], 0.5)
        self.assertAlmostEqual(ratio["here"], restore["here"] / off["here"], places=9)
        self.assertLessEqual(ratio["interval_95"][0], ratio["here"])
        self.assertGreaterEqual(ratio["interval_95"][1], ratio["here"])

    @unittest.skipIf("R3" in LEFT_OUT, "not measured")
    def test_r3_has_more_collisions_than_published_and_counts_every_miss(self):
        collisions, misses, none, found = [row["here"] for row in self.rows("R3")]
        self.assertGreaterEqual(collisions, 7273610)
        self.assertEqual(misses, none + found)
        self.assertLess(misses, 100)

    @unittest.skipIf("R9" in LEFT_OUT, "not measured")
    def test_r9_parts_that_contradict_each_other_never_assemble(self):
        here = {row["what"]: row["here"] for row in self.rows("R9")}
        for hybrid in ("restore", "exact"):
            self.assertEqual(here[f"angled pins (fig. 8.1), {hybrid}: assembles"], "0 of 2")
            self.assertEqual(here[f"pins too far apart (fig. 8.2), {hybrid}: assembles"], "0 of 2")
            self.assertEqual(here[f"one of these pins alone, {hybrid}: assembles"], "2 of 2")
        gained = [energy for what, energy in here.items() if "energy gained" in what]
        self.assertEqual(len(gained), 6)
        self.assertLess(max(gained), 1e-12)
        for file in self.files("R9"):
            if file.endswith(".csv"):
                with open(self.path(file)) as table:
                    rows = list(csv.DictReader(table))
                self.assertEqual([row["seed"] for row in rows], ["1", "2"])
                self.assertEqual(len({row["state_hash"] for row in rows}), 2, "every seed is its own trial")

    def test_r4_regressions_of_the_printed_rows_are_the_published_ones(self):
        published = {row["what"]: row["published"] for row in self.rows("R4")}
        for what, value in [("against constraints", 0.7075), ("against specializations", 0.8517)]:
            self.assertEqual([round(p, 4) for w, p in published.items() if what in w], [value])
        with open(self.path(self.files("R4")[0])) as f:
            self.assertEqual(len(f.readlines()), 1 + 64, "all states of six recognizers")

    @unittest.skipIf("R5" in LEFT_OUT, "not measured")
    def test_r5_run_files_are_runs(self):
        runs = [file for file in self.files("R5") if file.endswith(".h5")]
        self.assertEqual(len(runs), 2)
        for file in runs:
            self.succeed("replay", self.path(file), "--verify")

    def test_only_measures_only_what_is_named(self):
        report = json.loads(self.succeed("reproduce", "--quick", "--json", "--only", "R7", "-o", "alone").stdout)
        self.assertEqual({row["id"] for row in report["rows"]}, {"R7"})
        self.assertEqual([row["here"] for row in report["rows"]], [row["here"] for row in self.rows("R7")])

    def test_table_has_a_line_for_every_figure(self):
        table = self.succeed("reproduce", "--quick", "--only", "R7", "-o", self.path("here")).stdout
        self.assertEqual(len([line for line in table.splitlines() if line.startswith("R7")]), 2, table)
        self.assertTrue(os.path.exists(self.path("here/r7_coverage.csv")))

    def test_refuses_what_it_does_not_know_or_cannot_write(self):
        self.refuse(2, "R77", "reproduce", "--only", "R77")
        self.refuse(3, "peg_in_hole.lua", "reproduce", "--quick", "--only", "R1", "--scenarios", self.path("empty"))
        self.refuse(5, "no/", "reproduce", "--quick", "--only", "R7", "-o", self.write("no", "") + "/")


if __name__ == "__main__":
    unittest.main()
