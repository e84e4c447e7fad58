"""verisim tradeoff: settings against a truth, fronts, the setting to use, bad input."""
import csv
import json
import math
import os
import unittest

from program import SOURCE, ProgramTest

LONG = "VERISIM_LONG_TESTS" in os.environ
SANITIZED = os.environ.get("VERISIM_SANITIZE", "") != ""  # ten times slower

# As SMALL, and it can misbehave. A box is pressed on a plate and pushed along it.
PUSHED = """
local p = params{ voxelsize = 0.01, hybrid = "restore", timestep = 0.001, misbehave = "no", duration = 0.3, depth = 0.02 }
if p.misbehave == "error" then error("as it was told") end
defineSimulationParameters{ duration = p.misbehave == "hang" and 1e5 or p.duration, hybrid = p.hybrid,
                            timestep = p.timestep,
                            gravity = {0, 0, p.misbehave == "diverge" and -1e308 or 0}, allBodiesAreDynamic = true }
addObject{ name = "plate", fixed = true, voxelsize = p.voxelsize, Solid.box{0.3, 0.3, 0.02} }
local box = addObject{ name = "box", voxelsize = p.voxelsize, position = {0, 0, 0.05}, Solid.box{0.06, 0.06, 0.04} }
local hand = Devices.Hand{ name = "hand", tremor = 1e-4, path = {
  {position = {0, 0, 0.05}}, {position = {0, 0, p.depth}, speed = 0.5}, {position = {0.05, 0, p.depth}, speed = 0.5} } }
addDevice(hand)
grasp(hand, box)
outcome(p.voxelsize > 0.015 and "coarse" or "fine")
"""


def wilson(count, of, z=1.959963984540054):
    share, half = count / of, z * math.sqrt(count / of * (1 - count / of) / of + z * z / (4 * of * of))
    middle, scale = share + z * z / (2 * of), 1 + z * z / of
    return (middle - half) / scale, (middle + half) / scale


class Tradeoff(ProgramTest):
    def setUp(self):
        super().setUp()
        self.scenario = self.write("pushed.lua", PUSHED)

    def tradeoff(self, *args):
        return self.run_json("tradeoff", self.scenario, *args)

    def test_every_setting_has_times_counts_errors_and_a_front(self):
        table = self.tradeoff("--vary", "voxelsize=10mm,20mm", "--vary", "hybrid=off,restore,exact", "--repeat", 2)
        self.assertEqual(len(table["rows"]), 6)
        for row in table["rows"]:
            self.assertEqual(set(row["parameters"]), {"voxelsize", "hybrid"})
            self.assertLessEqual(row["time_us"]["low"], row["time_us"]["median"])
            self.assertLessEqual(row["time_us"]["median"], row["time_us"]["high"])
            self.assertGreater(row["cost"]["contacts"], 0)
            self.assertGreaterEqual(row["errors"]["force"]["most"], row["errors"]["force"]["median"])
            self.assertEqual(row["errors"]["flips"]["most"], float(row["parameters"]["voxelsize"] > 0.015))
        front = table["front"]
        self.assertEqual(front, [i for i in front if table["rows"][i]["dominated"] is False])
        exact = [r["errors"]["force"]["most"] for r in table["rows"] if r["parameters"]["hybrid"] == "exact"]
        off = [r["errors"]["force"]["most"] for r in table["rows"] if r["parameters"]["hybrid"] == "off"]
        self.assertLess(max(exact), min(off))

    @unittest.skipIf(SANITIZED, "test_every_setting_has_times_counts_errors_and_a_front runs the same code")
    def test_what_repeats_is_equal_but_for_the_clock(self):
        def counted(table):
            return [(r["parameters"], r["cost"], r["errors"]) for r in table["rows"]]
        args = ("--vary", "hybrid=off,exact", "--repeat", 2)
        first = self.tradeoff(*args)
        self.assertEqual(counted(first), counted(self.tradeoff(*args)))
        self.assertNotEqual(counted(first), counted(self.tradeoff(*args, "--seed", 7)))

    @unittest.skipIf(SANITIZED, "test_every_setting_has_times_counts_errors_and_a_front runs the same code")
    def test_repetitions_are_told_one_by_one(self):
        table = self.tradeoff("--vary", "hybrid=off,exact", "--repeat", 3)
        for row in table["rows"]:
            self.assertEqual(len({trial["seed"] for trial in row["trials"]}), 3)
            self.assertEqual(max(trial["force"] for trial in row["trials"]), row["errors"]["force"]["most"])
        self.assertEqual([t["seed"] for t in table["rows"][0]["trials"]], [t["seed"] for t in table["rows"][1]["trials"]])

    def test_a_setting_that_fails_is_a_row_that_says_why(self):
        table = self.tradeoff("--vary", "misbehave=no,error,diverge,hang", "--time-limit", 5, "--repeat", 2)
        fine, error, diverged, hung = table["rows"]
        self.assertNotIn("failed", fine)
        self.assertIn("as it was told", error["failed"])
        self.assertIn("finite", diverged["failed"])
        self.assertIn("--time-limit", hung["failed"])
        self.assertEqual(table["front"], [0])

    @unittest.skipIf(SANITIZED, "test_every_setting_has_times_counts_errors_and_a_front runs the same code")
    def test_the_truth_has_its_order_of_convergence(self):
        table = self.tradeoff("--vary", "hybrid=off,restore", "--repeat", 1)
        self.assertIn("exact", table["truth"])
        convergence = table["convergence"]
        self.assertEqual((convergence["ratio"], len(convergence["repetitions"])), (2, 1))
        self.assertTrue(convergence["repetitions"][0]["converges"], convergence)
        self.assertGreater(convergence["repetitions"][0]["order"], 0.5)
        self.assertLess(convergence["error_N"], min(r["errors"]["force"]["most"] for r in table["rows"]))

    @unittest.skipIf(SANITIZED, "test_every_setting_has_times_counts_errors_and_a_front runs the same code")
    def test_a_setting_that_is_the_truth_has_no_error(self):
        table = self.tradeoff("--vary", "voxelsize=10mm,20mm", "--truth", "voxelsize=10mm", "--repeat", 2)
        for kind in ("force", "force_max", "torque", "position", "flips"):
            self.assertEqual(table["rows"][0]["errors"][kind]["most"], 0, kind)
        self.assertGreater(table["rows"][1]["errors"]["force"]["most"], 0)

    @unittest.skipIf(SANITIZED, "test_every_setting_has_times_counts_errors_and_a_front runs the same code")
    def test_a_truth_that_is_not_finer_than_what_it_judges_is_said(self):
        def notes(*args):
            table = self.tradeoff("--vary", "voxelsize=10mm,20mm", "--repeat", 1, *args)
            return [n for n in table["notes"] if "not finer" in n]
        self.assertEqual(notes(), [])
        self.assertEqual(notes("--truth", "voxelsize=10mm", "--truth", "timestep=0.0005"), [])
        both = notes("--truth", "voxelsize=20mm")
        self.assertEqual(len(both), 2, both)
        self.assertIn("voxelsize (0.02) is not finer than that of the settings that it judges (0.01)", both[0])
        self.assertIn("--truth timestep=", both[1])

    @unittest.skipIf(SANITIZED, "test_every_setting_has_times_counts_errors_and_a_front runs the same code")
    def test_a_truth_of_another_scene_than_what_it_judges_is_said(self):
        def notes(*args):
            return [n for n in self.tradeoff("--repeat", 1, "--duration", "0.1", *args)["notes"] if "the scenario's own" in n]
        self.assertEqual(notes("--vary", "voxelsize=10mm,20mm", "--vary", "hybrid=off,exact"), [])
        (depth,) = notes("--vary", "depth=20mm,21mm")
        self.assertIn("the truth's depth is 0.02, the scenario's own", depth)
        self.assertIn("--set depth=", depth)
        (hybrid,) = notes("--vary", "hybrid=off,exact", "--truth", "voxelsize=5mm")
        self.assertIn("--truth hybrid=", hybrid)
        self.assertEqual(notes("--vary", "depth=20mm,21mm", "--truth", "depth=20mm"), [])

    @unittest.skipIf(SANITIZED, "test_every_setting_has_times_counts_errors_and_a_front runs the same code")
    def test_a_repetition_whose_force_hangs_on_the_step_is_named_with_its_order(self):
        # Where the pin's rim is caught at the hole's edge two blows follow each other within a step: of these seeds some.
        for seed in range(9, 25):
            done = self.succeed("tradeoff", os.path.join(SOURCE, "scenarios", "peg_in_hole.lua"), "--set", "clearance=1mm",
                                "--vary", "hybrid=restore,exact", "--duration", 0.6, "--repeat", 1, "--seed", seed)
            if "converges in the step in 1 of 1" not in done.stdout:
                break
        self.assertRegex(done.stdout, r"in repetition 0 \(order -?\d+\.\d\) it does not: what happens there hangs on the step")

    @unittest.skipIf(SANITIZED, "bounds_test and Auto below run the same code")
    def test_bounds_are_answered_with_a_setting_or_with_none(self):
        args = ("--vary", "hybrid=off,exact", "--repeat", 1)
        plain = self.tradeoff(*args)
        self.assertNotIn("setting", plain)
        off, exact = (r["errors"]["force"]["most"] for r in plain["rows"])
        self.assertLess(exact, off)
        between = f"{(exact + off) / 2:.6f}N"
        setting = self.tradeoff(*args, "--error", between)["setting"]
        self.assertEqual((setting["parameters"], setting["coverage"]), ({"hybrid": "exact"}, 0.5))
        told = self.succeed("tradeoff", self.scenario, *args, "--error", between).stdout.splitlines()
        self.assertEqual(told[-1], "  bounds that the one repetition kept are expected to hold in 50 % of further trials; "
                                   "--repeat 19 makes it 95 %")
        self.assertEqual(plain["coverage"], 0.5)
        self.assertEqual(self.tradeoff(*args, "--budget", "1s")["setting"]["parameters"], {"hybrid": "exact"})
        done = self.run_program("tradeoff", self.scenario, *args, "--budget", "1ns", "--json")
        self.assertEqual(done.returncode, 1)
        self.assertIsNone(json.loads(done.stdout)["setting"])
        self.assertIn("no setting keeps a median frame", done.stderr)

    def test_a_folder_gets_table_csv_and_plot_and_is_written_again(self):
        for _ in range(2):
            done = self.succeed("tradeoff", self.scenario, "--vary", "hybrid=off,exact", "--repeat", 1, "-o", "out")
        self.assertIn("front by 'force'", done.stdout)
        with open(self.path("out/tradeoff.json")) as f:
            self.assertEqual(json.load(f)["format"], "verisim-tradeoff")
        with open(self.path("out/tradeoff.csv"), newline="") as f:
            rows = list(csv.DictReader(f))
        self.assertEqual([r["hybrid"] for r in rows], ["off", "exact"])
        self.assertGreater(float(rows[0]["force_most_N"]), float(rows[1]["force_most_N"]))
        for column in ("load_us_per_ms", "torque_median_Nm", "overlap_most_m", "wrench_most", "flips_median"):
            self.assertIn(column, rows[0])
        with open(self.path("out/tradeoff.svg")) as f:
            self.assertIn("<svg", f.read())
        self.write("out/tradeoff.csv", "mine")
        self.refuse(5, "tradeoff.csv", "tradeoff", self.scenario, "--vary", "hybrid=off,exact", "-o", "out")

    @unittest.skipIf(SANITIZED, "test_every_setting_has_times_counts_errors_and_a_front runs the same code")
    def test_the_table_lines_up(self):
        done = self.succeed("tradeoff", self.scenario, "--vary", "hybrid=off,exact", "--repeat", 1)
        lines = done.stdout.splitlines()
        head = next(i for i, line in enumerate(lines) if "frame, us" in line)
        end = lines[head].index("frame, us") + len("frame, us")
        for line in lines[head + 1:head + 3]:
            self.assertTrue(line[end - 1].isdigit() and line[end] == " ", line)

    @unittest.skipIf(SANITIZED, "test_every_setting_has_times_counts_errors_and_a_front runs the same code")
    def test_what_no_parameter_reaches_is_said(self):
        notes = self.tradeoff("--vary", "hybrid=off,exact", "--repeat", 1)["notes"]
        for dial in ("spacing", "integrator", "contact", "alignment"):
            self.assertIn(f"'{dial}'", notes[0])
        self.assertNotIn("'voxelsize'", notes[0])

    def test_bad_input_is_refused_before_anything_runs(self):
        def refuse(code, words, *args):
            self.refuse(code, words, "tradeoff", self.scenario, *args)
        refuse(2, "the sweep is empty")
        refuse(2, "the grid is empty", "--vary", "hybrid=")
        refuse(2, "one setting only", "--vary", "hybrid=off")
        refuse(2, "are one value", "--vary", "voxelsize=10mm,0.01")
        refuse(3, ["no parameter 'hybird'", "did you mean 'hybrid'"], "--vary", "hybird=off,exact")
        refuse(3, "no parameter 'weight'", "--vary", "hybrid=off,exact", "--truth", "weight=1")
        refuse(2, "--set", "--vary", "hybrid=off,exact", "--set", "hybrid=off")
        refuse(2, "no error is called", "--vary", "hybrid=off,exact", "--by", "weight")
        refuse(2, "unit", "--vary", "hybrid=off,exact", "--error", "1lb")
        refuse(2, "unit", "--vary", "hybrid=off,exact", "--error", "1mm", "--by", "force")
        refuse(2, "no time", "--vary", "hybrid=off,exact", "--budget", "1mm")
        refuse(3, ["the truth fails", "as it was told", "--truth"], "--vary", "hybrid=off,exact", "--truth", "misbehave=error")
        done = self.run_program("tradeoff", self.scenario, "--vary", "misbehave=error", "--vary", "voxelsize=10mm,20mm",
                                "--truth", "misbehave=no")
        self.assertEqual(done.returncode, 1, "every setting failed, and the table says so")
        self.assertRegex(done.stderr, "no setting has figures.*as it was told")
        self.refuse(3, "nowhere.lua", "tradeoff", "nowhere.lua", "--vary", "a=1,2")


class Auto(ProgramTest):
    """precision = "auto": the setting comes from a table that lies beside the scenario."""

    def setUp(self):
        super().setUp()
        self.scenario = self.write("pushed.lua", PUSHED.replace("timestep = p.timestep,",
                                                                "timestep = p.timestep, precision = 'auto', error = '0.5N',"))

    def make_table(self, *args):
        return self.run_json("tradeoff", self.scenario, "--vary", "hybrid=off,exact", "--vary", "voxelsize=10mm,20mm",
                             "--repeat", 2, "-o", ".", *args)

    def change(self, old, new):
        with open(self.scenario) as f:
            text = f.read()
        self.assertIn(old, text)
        self.write("pushed.lua", text.replace(old, new))

    def run_file(self, name, *args):
        summary = self.run_json("run", self.scenario, "-o", self.path(name), *args)
        import h5py
        with h5py.File(self.path(name)) as f:
            events = [(e["kind"].decode(), e["text"].decode()) for e in f["events"][()]]
            return json.loads(f.attrs["parameters"]), events, summary

    def test_the_choice_is_a_table_s_and_stands_in_the_run(self):
        self.refuse(3, ["there is no tradeoff.json", "verisim tradeoff pushed.lua"], "run", self.scenario)
        table = self.make_table()
        rows = [r for r in table["rows"] if r["errors"]["force"]["most"] <= 0.5]
        self.assertTrue(0 < len(rows) < 4, [r["errors"]["force"] for r in table["rows"]])
        best = min(rows, key=lambda r: r["load"])
        parameters, events, summary = self.run_file("a.h5")
        self.assertEqual({k: parameters[k] for k in ("hybrid", "voxelsize")}, best["parameters"])
        chosen = [text for kind, text in events if kind == "precision"]
        self.assertEqual(len(chosen), 1)
        self.assertIn("tradeoff.json", chosen[0])
        self.assertIn(f"hybrid={best['parameters']['hybrid']}", chosen[0])
        # The same run with that setting said outright.
        plain = self.write("plain.lua", PUSHED)
        sets = [x for k, v in best["parameters"].items() for x in ("--set", f"{k}={v}")]
        self.assertEqual(self.run_json("run", plain, *sets, "-o", self.path("b.h5"))["state_hash"], summary["state_hash"])

    def test_a_run_file_holds_the_table_and_replays(self):
        self.make_table()
        self.run_file("a.h5")
        os.remove(self.path("tradeoff.json"))
        self.assertIn("equal", self.succeed("replay", self.path("a.h5"), "--verify").stdout)

    @unittest.skipIf(SANITIZED, "test_the_choice_is_a_table_s_and_stands_in_the_run runs the same code")
    def test_a_batch_s_index_has_what_was_chosen(self):
        self.make_table()
        parameters, _, summary = self.run_file("a.h5")
        self.succeed("batch", self.scenario, "--vary", f"depth={parameters['depth']}", "-o", self.path("b"))
        with open(os.path.join(self.path("b"), "index.csv"), newline="") as f:
            row, = csv.DictReader(f)
        self.assertEqual((row["hybrid"], float(row["voxelsize"])), (parameters["hybrid"], parameters["voxelsize"]))

    @unittest.skipIf(SANITIZED, "test_the_choice_is_a_table_s_and_stands_in_the_run runs the same code")
    def test_what_the_command_line_says_is_kept(self):
        self.make_table()
        parameters, _, _ = self.run_file("a.h5", "--set", "voxelsize=20mm")
        self.assertEqual(parameters["voxelsize"], 0.02)
        self.refuse(3, "no setting of tradeoff.json keeps", "run", self.scenario, "--set", "voxelsize=15mm")

    def warnings(self, events):
        return [t for k, t in events if k == "warning" and "precision" in t]

    def test_a_table_that_bounds_less_than_95_percent_is_said_with_the_remedy(self):
        self.make_table()
        _, events, _ = self.run_file("a.h5")
        self.assertEqual(len(self.warnings(events)), 1, events)
        self.assertRegex(self.warnings(events)[0], "tradeoff.json: bounds that all 2 repetitions kept .* 66.7 % of further trials; --repeat 19 makes it 95 %")
        self.assertIn("; 66.7 % of trials; ", [t for k, t in events if k == "precision"][0])
        with open(self.path("tradeoff.json")) as f:
            text = f.read()
        self.write("tradeoff.json", text.replace('"repeat":2', '"repeat":19').replace('"repeat": 2', '"repeat": 19'))
        _, events, _ = self.run_file("b.h5")
        self.assertEqual(self.warnings(events), [])
        self.assertIn("; 95 % of trials; ", [t for k, t in events if k == "precision"][0])

    def test_another_trial_than_the_table_s_is_refused(self):
        table = self.make_table()
        refused = ["pushed.lua:4", "tradeoff.json is of another trial", "verisim tradeoff pushed.lua", 'precisionOutside = "careful"']
        for args, words in ((("--set", "depth=0.021"), "depth is 0.021 here and 0.02 there"),
                            (("--duration", "0.2"), "it lasts 0.2 s here and 0.3 s there"),
                            (("--duration", "0.6"), "it lasts 0.6 s here and 0.3 s there")):
            self.refuse(3, [*refused, words], "run", self.scenario, *args)
        done = self.run_program("batch", self.scenario, "--vary", "depth=0.02,0.021", "-o", self.path("b"))
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(os.path.join(self.path("b"), "index.csv"), newline="") as f:
            inside, outside = csv.DictReader(f)
        self.assertEqual((inside["status"], outside["status"]), ("done", "failed"))
        self.assertIn("is of another trial", outside["error"])
        # As the script says it outright: the most accurate one of those that keep the bounds, and no promise.
        self.change("precision = 'auto',", "precision = 'auto', precisionOutside = 'careful',")
        rows = [r for r in table["rows"] if r["errors"]["force"]["most"] <= 0.5]
        parameters, events, _ = self.run_file("b.h5", "--set", "depth=0.021")
        best = min(rows, key=lambda r: r["errors"]["force"]["most"])
        self.assertEqual({k: parameters[k] for k in best["parameters"]}, best["parameters"])
        self.assertTrue([t for t in self.warnings(events) if "depth is 0.021 here and 0.02 there" in t and "the bounds are not promised" in t])
        self.assertIn("of another trial, nothing is promised", [t for k, t in events if k == "precision"][0])
        self.assertIn("equal", self.succeed("replay", self.path("b.h5"), "--verify").stdout)
        parameters, events, _ = self.run_file("c.h5")  # inside of the table nothing is different
        self.assertFalse([t for t in self.warnings(events) if "another trial" in t])
        self.change("'careful'", "'bold'")
        self.refuse(3, "precisionOutside is 'bold' but must be", "run", self.scenario)

    @unittest.skipIf(SANITIZED, "test_the_choice_is_a_table_s_and_stands_in_the_run runs the same code")
    def test_a_table_of_a_trial_that_lasts_otherwise_is_of_that_alone(self):
        self.make_table("--duration", "0.2")
        self.refuse(3, "it lasts 0.3 s here and 0.2 s there", "run", self.scenario)
        self.run_file("a.h5", "--duration", "0.2")

    def test_a_script_that_was_changed_since_is_said(self):
        self.make_table()
        self.change("speed = 0.5", "speed = 0.4")
        _, events, _ = self.run_file("c.h5")
        self.assertTrue([t for t in self.warnings(events) if "was changed" in t], events)

    def test_bounds_that_cannot_be_kept_or_read_are_errors_with_their_line(self):
        self.make_table()
        for bound, words in (("error = '1nN'", ["pushed.lua:4", "no setting of tradeoff.json keeps"]),
                             ("budget = '1ns'", "no setting of tradeoff.json keeps"),
                             ("error = '1lb'", "no unit"), ("budget = '1N'", "is no time"),
                             ("error = '1N', errorBy = 'weight'", "no error is called 'weight'"),
                             ("frameRate = 60", "without a bound")):
            self.write("pushed.lua", PUSHED.replace("timestep = p.timestep,",
                                                    f"timestep = p.timestep, precision = 'auto', {bound},"))
            self.refuse(3, words, "run", self.scenario)
        self.write("pushed.lua", PUSHED.replace("timestep = p.timestep,", "timestep = p.timestep, error = '1N',"))
        self.refuse(3, 'precision = "auto"', "run", self.scenario)

    def test_a_damaged_table_and_one_of_another_scenario_are_refused(self):
        self.make_table()
        with open(self.path("tradeoff.json")) as f:
            text = f.read()
        self.write("tradeoff.json", text[:len(text) // 2])
        self.refuse(3, ["tradeoff.json: is no table of 'verisim tradeoff': line ", "is no JSON, or the file ends in it",
                        "make it with verisim tradeoff -o FOLDER"], "run", self.scenario)
        self.write("tradeoff.json", text.replace('"step_s"', '"steps"'))
        self.refuse(3, "rows[0].step_s is not there", "run", self.scenario)
        self.write("tradeoff.json", text.replace("pushed.lua", "pulled.lua"))
        self.refuse(3, "is a table of pulled.lua", "run", self.scenario)
        self.write("tradeoff.json", text.replace('"voxelsize"', '"voxel"'))
        self.refuse(3, "varies 'voxel'", "run", self.scenario)
        self.change("error = '0.5N'", "error = '0.5N', precisionTable = '../tradeoff.json'")
        self.refuse(3, "there is no ../tradeoff.json", "run", self.scenario)


@unittest.skipIf(SANITIZED, "a minute of trials in a usual build; their code runs above")
class AutoKeepsItsBounds(ProgramTest):
    """Of trials that the table was not made from, at least 95 % keep the bounds: other seeds are other tremors, and the
    hand aims and tilts otherwise in each."""

    PATIENCE = 3600 if LONG else 300
    # N, us: the pin jams in some trials, and its force is then chaotic. Which of the settings that keep the error is
    # chosen hangs on measured times, and three trials bound three of four further ones: so the error that is asked for
    # is one that each of the four with precise geometry keeps in the short form's six trials (2.8 N was the most), and
    # voxels alone do not in those of the table (6.4 N and more).
    ERROR, BUDGET = 4, 100

    def setUp(self):
        super().setUp()
        with open(os.path.join(SOURCE, "scenarios", "peg_in_hole.lua")) as f:
            text = f.read()
        for old, new in (("parameter(0.005, \"m\", \"between", "parameter(0.001, \"m\", \"between"),
                         ("  duration = p.duration,\n", f"  duration = p.duration, precision = 'auto', "
                          f"error = '{self.ERROR}N', budget = '{self.BUDGET}us',\n"),
                         ("p.approach / scale, 0, 0}", "p.approach / scale * math.random(), 0, 0}"),
                         ("angularError = {0, p.tilt, 0},\n  lead", "angularError = {0, p.tilt * math.random(), 0},\n  lead")):
            self.assertIn(old, text)
            text = text.replace(old, new)
        self.scenario = self.write("pin.lua", text)

    def kept(self, made_of, tried, duration):
        """Of trials of seeds that the table has not: how many keep the error, how many the budget, of how many."""
        common = ("--duration", duration)
        table = self.run_json("tradeoff", self.scenario, "--vary", "hybrid=off,restore,exact", "--vary",
                              "voxelsize=4.5mm,9mm", "--repeat", made_of, "-o", ".", *common)
        chosen = json.loads(self.succeed("run", self.scenario, "-o", "a.h5", "--json", *common).stdout)
        self.assertEqual(chosen["end"], "done")
        import h5py
        with h5py.File(self.path("a.h5")) as f:
            chosen = json.loads(f.attrs["parameters"])
        size = f"{chosen['voxelsize']!r}"
        self.assertNotEqual(chosen["hybrid"], "off", "voxels alone do not keep it here")
        fresh = self.run_json("tradeoff", self.scenario, "--vary", f"hybrid={chosen['hybrid']},off", "--set",
                              f"voxelsize={size}", "--seed", 1000, "--repeat", tried, *common)
        seeds = [{t["seed"] for t in made["rows"][0]["trials"]} for made in (table, fresh)]
        self.assertFalse(seeds[0] & seeds[1])
        trials = fresh["rows"][0]["trials"]
        most = next(r for r in table["rows"] if r["parameters"] == {k: chosen[k] for k in r["parameters"]})
        tightest = sum(t["force"] <= most["errors"]["force"]["most"] for t in trials)
        return tightest, (sum(t["force"] <= self.ERROR for t in trials), sum(t["time_us"] <= self.BUDGET for t in trials),
                sum(t["force"] <= self.ERROR and t["time_us"] <= self.BUDGET for t in trials), len(trials))

    def test_in_trials_that_the_table_was_not_made_from(self):
        if not LONG:
            _, (error, _, _, tried) = self.kept(3, 6, 2)
            self.assertEqual(error, tried)  # times are not judged here
            return
        tightest, (error, budget, both, tried) = self.kept(19, 100, 2)
        low, high = wilson(both, tried)
        print(f"{tightest} of {tried} stay within the greatest error of the 19 that the table was made from (95 expected)")
        print(f"{both} of {tried} kept both ({error} the error, {budget} the budget): "
              f"{100 * both / tried:.1f} %, 95 % interval {100 * low:.1f} to {100 * high:.1f} %")
        self.assertGreaterEqual(both / tried, 0.95)


if __name__ == "__main__":
    unittest.main()
