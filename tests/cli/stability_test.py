"""`verisim stability`: what it prints and writes, and that it says the same however it is computed."""
import csv
import json
import math
import os
import unittest
from xml.etree import ElementTree

from program import ProgramTest, SMALL, SOURCE

SANITIZED = os.environ["VERISIM_SANITIZE"] != ""  # ten times slower
OUTCOMES = {"stable", "limit-cycle", "diverged", "refused"}


class Stability(ProgramTest):
    def rows(self, *arguments):
        done = self.run_program("stability", "--json", "--quiet", *arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)

    def test_a_scenarios_ledger_closes_and_is_what_poses_and_wrenches_say(self):
        self.write("small.lua", SMALL)
        said = self.rows("--only", "ledgers", "small.lua", "--set", "duration=0.2")
        self.assertEqual((said["maps"], said["extremes"], said["failed"]), ([], [], []))
        ledger, = said["ledgers"]
        figures = {name: f["value"] for name, f in ledger["figures"].items()}
        self.assertEqual((ledger["what"], ledger["outcome"], ledger["holds"]), ("small.lua", "stable", True))
        self.assertEqual(figures["frames"], 200)
        self.assertGreater(figures["input"], 0)
        self.assertLess(abs(figures["contact"] - figures["contact_recomputed"]), 1e-9)
        self.assertLess(abs(figures["kinetic"] - figures["kinetic_recomputed"]), 1e-9)
        self.assertLess(abs(figures["closing_error"]), 1e-12)
        # Nothing moves at the start: what was put in is all that there is.
        self.assertLess(abs(sum(figures[k] for k in ("kinetic", "coupling", "gravity", "dissipated", "contact", "numerical"))
                            - figures["input"]), 1e-9)

    def test_a_scenario_that_is_named_and_cannot_be_read_is_an_error(self):
        broken = self.write("broken.lua", "addObject{")
        self.refuse(3, "broken.lua:1", "stability", "--only", "ledgers", broken)
        fine = self.write("fine.lua", "local p = params{speed = 1}")
        self.refuse(3, ["no parameter 'spede'", "speed"], "stability", "--only", "ledgers", fine, "--set", "spede=1")

    def test_what_is_for_ledgers_alone_is_not_ignored(self):
        self.refuse(2, ["SCENARIO", "--only ledgers"], "stability", "--only", "maps", "none.lua")
        self.refuse(2, "--set", "stability", "--only", "extremes", "--set", "a=b")
        self.refuse(2, "--duration", "stability", "--only", "extremes", "--duration", "1")
        self.refuse(2, "--seed", "stability", "--only", "maps", "--seed", "1")
        self.refuse(2, "--threads", "stability", "--only", "maps", "--threads", "2")
        self.refuse(2, "--bind", "stability", "--only", "maps", "--bind", "a=b")
        self.refuse(3, "nowhere", "stability", "--only", "ledgers", "--scenarios", "nowhere")

    @unittest.skipIf(SANITIZED, "one scenario's ledger is computed above")
    def test_a_ledger_is_of_the_seed_and_the_trace_that_are_named(self):
        def input_of(scenario, *options):
            ledger, = self.rows("--only", "ledgers", os.path.join(SOURCE, "scenarios", scenario), "--duration", "0.3", *options)["ledgers"]
            return ledger["figures"]["input"]["value"]
        drawn = input_of("peg_in_hole.lua", "--seed", "1")
        self.assertEqual(input_of("peg_in_hole.lua", "--seed", "1", "--threads", "2", "--simd", "scalar"), drawn)
        self.assertNotEqual(input_of("peg_in_hole.lua", "--seed", "2"), drawn)
        self.succeed("trace", "synth", "reach", "-o", self.path("hand.csv"), "--set", "wait=0.01", "--set", "time=0.2")
        self.assertNotEqual(input_of("reach.lua", "--bind", "omni=" + self.path("hand.csv")), input_of("reach.lua"))
        self.refuse(3, "no device 'foot'", "stability", "--only", "ledgers", os.path.join(SOURCE, "scenarios", "reach.lua"), "--bind",
                    "foot=hand.csv")

    def test_wrong_usage(self):
        self.assertEqual(self.run_program("stability", "--only", "weather").returncode, 2)
        self.assertEqual(self.run_program("stability", "--jobs", "0").returncode, 2)
        self.assertEqual(self.run_program("stability", "none.lua").returncode, 3)

    def test_what_is_not_its_own_is_not_replaced(self):
        os.mkdir(self.path("out"))
        self.write("out/extremes.csv", "mine,yours\n1,2\n")
        self.refuse(5, "file: the folder cannot be made", "stability", "--only", "ledgers", "-o", self.write("file", ""), self.write("small.lua", SMALL))
        self.refuse(5, "extremes.csv", "stability", "--only", "ledgers", "-o", "out", self.write("small.lua", SMALL))

    def test_help_has_an_example(self):
        done = self.run_program("stability", "--help")
        self.assertEqual(done.returncode, 0)
        self.assertIn("Example: verisim stability", done.stdout)
        self.assertIn("Exit code 1 if", done.stdout)


class Everything(ProgramTest):
    @unittest.skipIf(SANITIZED, "hand_on_wall_test and pressed_body_test compute such maps")
    def test_maps_are_the_same_however_many_rows_are_computed_at_once(self):
        done = {jobs: self.run_program("stability", "--only", "body-on-wall", "--quiet", "--json", "--jobs", jobs,
                                       "-o", "out" + jobs) for jobs in ("1", "3")}
        self.assertEqual(done["1"].stdout, done["3"].stdout)
        with open(self.path("out1/stability.json"), encoding="utf-8") as file:
            self.assertEqual(json.load(file), {"format": "verisim-stability", **json.loads(done["1"].stdout)})
        for name in sorted(os.listdir(self.path("out1"))):
            with open(self.path("out1/" + name), "rb") as one, open(self.path("out3/" + name), "rb") as other:
                self.assertEqual(one.read(), other.read(), name)

    @unittest.skipIf(SANITIZED, "extremes_test computes such rows")
    def test_what_fails_at_an_extreme_is_told(self):
        said = self.rows("extremes", "-o", "out")
        self.assertGreater(len(said["extremes"]), 40)
        # What fails and is told of is no failure of the command: rows() has asserted exit code 0.
        self.assertEqual(said["failed"], [])
        self.assertTrue([row for row in said["extremes"] if not row["holds"]])
        for row in said["extremes"]:
            self.assertIn(row["outcome"], OUTCOMES)
            self.assertTrue(row["theory"])
            self.assertTrue(row["holds"] or row["why"], f"{row['what']} fails and nobody is told")
            for name, figure in row["figures"].items():
                self.assertTrue(figure["value"] is not None and math.isfinite(figure["value"]), f"{row['what']}: {name}")
        with open(self.path("out/extremes.csv"), encoding="utf-8") as file:
            self.assertEqual([r["what"] for r in csv.DictReader(file)], [r["what"] for r in said["extremes"]])

    @unittest.skipIf(SANITIZED, "extremes_test computes such rows")
    def test_an_extreme_without_an_answer_is_a_failure(self):
        # Without the program that makes solids, and without what it made before.
        nothing = {**os.environ, "VERISIM_CAD": self.path("none"), "VERISIM_CACHE": self.path("cache")}
        done = self.run_program("stability", "--only", "extremes", "--json", "--quiet", env=nothing)
        self.assertEqual(done.returncode, 1, done.stderr)
        said = json.loads(done.stdout)
        refused = [row["what"] for row in said["extremes"] if row["outcome"] == "refused"]
        self.assertTrue(refused)
        self.assertEqual(said["failed"], refused)

    @unittest.skipIf(SANITIZED, "one scenario's ledger is computed above")
    def test_ledgers_are_of_every_scenario_that_is_shipped(self):
        said = self.rows("ledgers", "--duration", "0.05")
        shipped = sorted(name for name in os.listdir(os.path.join(SOURCE, "scenarios")) if name.endswith(".lua"))
        shipped.remove("iso286.lua")  # others require it
        self.assertEqual([row["what"] for row in said["ledgers"]], shipped)

    @unittest.skipIf(SANITIZED, "hand_on_wall_test and pressed_body_test compute such maps")
    def test_maps_hold_their_bounds(self):
        is_long = "VERISIM_LONG_TESTS" in os.environ
        said = self.rows("maps") if is_long else self.rows("body-on-wall", "--only", "passive-wall", "-o", "maps")
        bounds = [row for row in said["maps"] if row["kind"] == "bound"]
        self.assertGreater(len(bounds), 10)
        for row in bounds:
            figures = {name: f["value"] for name, f in row["figures"].items()}
            self.assertAlmostEqual(figures["difference"], figures["found"] / figures["theory"] - 1)
            if "tolerance" in figures:
                self.assertLessEqual(abs(figures["difference"]), figures["tolerance"], row["what"])
            else:
                self.assertTrue(row["why"], row["what"])
        cells = [row for row in said["maps"] if row["kind"] == "cell"]
        if is_long:
            self.assertEqual({row["outcome"] for row in cells}, OUTCOMES - {"refused"})
            return
        tree = ElementTree.parse(self.path("maps/body-on-wall.svg"))
        dots = tree.findall(".//{http://www.w3.org/2000/svg}circle")
        self.assertEqual(len(dots), 3 + len(cells))
        with open(self.path("maps/maps.csv"), newline="") as f:
            columns = next(csv.reader(f))
        self.assertEqual(len(columns), len(set(columns)), columns)

    def rows(self, only, *arguments):
        done = self.run_program("stability", "--only", only, "--json", "--quiet", *arguments)
        self.assertEqual(done.returncode, 0, done.stdout[-2000:])
        return json.loads(done.stdout)


if __name__ == "__main__":
    unittest.main()
