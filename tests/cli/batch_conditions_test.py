"""verisim batch: how it was computed, what is done again, who warned, what was in effect; one schema however it was made."""
import json
import os
import signal
import sqlite3
import unittest

from batches import LIGHT, LIGHTER, Batches, children

# A cold run and a warm one differ: the plate is a model that is prepared.
DIALS = """
local p = params{ hybrid = "restore", integrator = "semi-implicit", duration = 0.05, seed = 3, dwell = 0.05 }
defineSimulationParameters{ hybrid = p.hybrid, integrator = p.integrator, duration = p.duration, seed = p.seed }
addObject{ name = "plate", fixed = true, voxelsize = 0.01, Solid.box{0.3, 0.3, 0.02} }
local box = addObject{ name = "box", voxelsize = 0.01, position = {0, 0, 0.05}, Solid.box{0.06, 0.06, 0.04} }
local hand = Devices.Hand{ name = "hand", path = { {position = {0, 0, 0.05}}, {position = {0, 0, 0.02}, speed = 0.5} } }
addDevice(hand)
grasp(hand, box)
"""

# Each run measures other things than the others, the first of them last by name.
MEASURES = """
local p = params{ k = 1 }
defineSimulationParameters{ duration = 0.01 }
measure("z" .. (9 - p.k), p.k, "m")
if p.k % 2 == 0 then measure("a" .. p.k, p.k, "s") end
measure("both", p.k, "1")
"""

# It is killed, hangs or warns until a file is there.
UNTIL = """
local p = params{ k = 1, say = "" }
defineSimulationParameters{ duration = p.k > 1 and 1e5 or 0.01 }
if p.say ~= "" then addDevice(Devices.Sensable.PhantomOmni{name = p.say, scale = 1}) end
measure("k", p.k, "1")
"""


class Conditions(Batches):
    def setUp(self):
        super().setUp()
        self.env = {**os.environ, "VERISIM_CACHE": self.path("prepared")}

    def batch(self, folder, *args, **options):
        return super().batch(folder, *args, **{"env": self.env, **options})

    def manifest(self, folder):
        with open(os.path.join(self.path(folder), "batch.json")) as f:
            return json.load(f)

    def compared(self, a, b, code=0):
        done = self.run_program("compare", self.path(a), self.path(b), "--json")
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return json.loads(done.stdout)

    def test_batch_json_and_every_row_say_how_it_was_computed(self):
        args = ["--vary", "speed=0.4,0.5", "--repeat", 2]
        self.batch_json("cold", *args, "--jobs", 1)
        self.batch_json("warm", *args, "--jobs", 2)
        self.batch_json("off", *args, "--jobs", 2, "--no-cache", "--keep", "all", "--simd", "scalar")
        cold, warm, off = (self.manifest(folder)["computed"] for folder in ("cold", "warm", "off"))
        self.assertEqual([(c["jobs"], c["cache"], c["runs"]) for c in cold], [(1, "cold", 1), (1, "warm", 3)])
        self.assertEqual([(c["jobs"], c["cache"], c["runs"]) for c in warm], [(2, "warm", 4)])
        self.assertEqual([(c["jobs"], c["cache"], c["simd"], c["recorded"]) for c in off], [(2, "off", "scalar", 1)])
        for computed in (cold, warm, off):
            self.assertTrue(computed[0]["cpu"] and computed[0]["cores"] >= 1 and computed[0]["threads"] == 1, computed)
        self.assertEqual([r["cache"] for r in self.rows("cold", "timing.csv")], ["cold", "warm", "warm", "warm"])
        self.assertEqual(self.index("cold"), self.index("warm"))
        with self.database(os.path.join(self.path("cold"), "index.sqlite")) as db:
            known = {row[0] for row in db.execute("SELECT \"column\" FROM unit")}
        self.assertLessEqual(set(self.rows("cold", "timing.csv")[0]), known)

        report = self.compared("cold", "warm")
        self.assertEqual((report["verdict"], report["counts"]), ("same", []))
        self.assertIn("times not comparable: jobs 1 and 2; cache cold and warm in 1 of 4 runs", report["notes"])
        self.assertTrue(report["times"])
        for time in report["times"]:
            self.assertEqual(time["change"], "no verdict", time)
            self.assertIn("not comparable: jobs 1 and 2", time["note"])
        self.assertIn("cache warm and off", " ".join(self.compared("warm", "off")["notes"]))
        self.assertIn("recorded 0 and 1", " ".join(self.compared("warm", "off")["notes"]))

    def test_runs_under_the_same_conditions_are_compared_and_the_others_left_out(self):
        args = ["--vary", "speed=0.4,0.5", "--repeat", 2, "--jobs", 1]
        self.batch_json("cold", *args)
        self.batch_json("warm", *args)
        report = self.compared("cold", "warm")
        self.assertIn("times of 1 of 4 runs not comparable, and left out: cache cold and warm in 1 of 4 runs", report["notes"])
        (time,) = [t for t in report["times"] if t["name"] == "process_s"]
        self.assertEqual(time["repetitions"], [3, 3])

    def test_interruptions_and_shards_keep_their_own(self):
        args = ["--vary", "speed=0.4,0.45,0.5", "--vary", "misbehave=no,error", *LIGHT]
        self.batch_json("whole", *args, "--jobs", 2)
        for i in (1, 2):
            self.batch_json(f"s{i}", *args, "--shard", f"{i}/2", "--jobs", i)
        self.run_json("batch", "merge", self.path("merged"), self.path("s1"), self.path("s2"))
        manifest = self.manifest("merged")
        self.assertEqual(manifest["shards_merged"], 2)
        self.assertEqual([(c["jobs"], c["runs"]) for c in manifest["computed"]], [(1, 3), (2, 3)])
        self.assertEqual(self.index("merged"), self.index("whole"))
        self.batch_json("merged", *args)  # goes on, with nothing to do
        self.assertEqual(self.manifest("merged")["computed"], manifest["computed"])
        self.assertEqual(self.manifest("merged")["shards_merged"], 2)
        with self.database(os.path.join(self.path("whole"), "index.sqlite")) as db:
            for table in ("run", "timing"):
                db.execute(f"DELETE FROM {table} WHERE run = 5")
        self.batch_json("whole", *args, "--jobs", 2)
        self.assertEqual([(c["jobs"], c["runs"]) for c in self.manifest("whole")["computed"]], [(2, 5), (1, 1)])
        self.assertEqual(self.index("merged"), self.index("whole"))


class Retries(Batches):
    def test_a_killed_run_is_done_again_if_that_is_asked_for(self):
        args = ["--vary", "misbehave=no,error", "--vary", "speed=0.4,0.5"]
        self.batch_json("whole", *args)
        self.batch_json("b", *args)
        with self.database(os.path.join(self.path("b"), "index.sqlite")) as db:  # as a kill of run 1 would have it
            db.execute("UPDATE run SET status = 'failed', error = 'ended by SIGKILL', outcome = NULL WHERE run = 1")
            db.execute("UPDATE timing SET answered = 0 WHERE run = 1")
        done = self.batch("b", *args)
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, "^error: .*1 of 4 runs could not be done.*--retry-failed does them again\n$")
        self.assertNotEqual(self.index("b"), self.index("whole"))
        said = self.batch_json("b", *args, "--retry-failed")
        self.assertEqual((said["done"], said["failed"]), (2, 2), "an error of the script is an answer")
        self.assertEqual(self.index("b"), self.index("whole"))
        with self.database(os.path.join(self.path("b"), "index.sqlite")) as db:
            self.assertEqual(db.execute("SELECT count(*) FROM timing JOIN run USING (run)").fetchone(), (4,))
        self.assertEqual(self.batch("b", *args, "--retry-failed").returncode, 0, "with nothing to do")

    def test_a_real_kill_and_more_time(self):
        self.scenario = self.write("until.lua", UNTIL)
        process = self.start("b", "--vary", "k=1,2", "--jobs", "1")
        self.wait_for(lambda: self.done("b") == 1 and children(process.pid))
        os.kill(children(process.pid)[0], signal.SIGKILL)
        _, err = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 1, err)
        self.assertIn("--retry-failed", err)
        done = self.batch("b", "--vary", "k=1,2", "--retry-failed", "--time-limit", 1)
        self.assertEqual(done.returncode, 1)
        self.assertEqual([r["status"] for r in self.rows("b")], ["done", "timeout"])
        self.assertIn("--retry-failed does them again, --time-limit gives more time", done.stderr)

    def test_killed_while_it_does_them_again_it_has_not_ended(self):
        self.scenario = self.write("until.lua", UNTIL)
        self.batch("b", "--vary", "k=1,2", "--time-limit", 1)
        process = self.start("b", "--vary", "k=1,2", "--retry-failed")
        self.wait_for(lambda: children(process.pid))
        process.kill()
        process.communicate()
        self.refuse(3, "the batch has not ended", "compare", self.path("b"), self.path("b"))
        self.batch("b", "--vary", "k=1,2", "--time-limit", 1)
        self.assertEqual([r["status"] for r in self.rows("b")], ["done", "timeout"])

    def test_help_says_it(self):
        self.assertIn("--retry-failed", self.succeed("batch", "--help").stdout)


class Words(Batches):
    def test_a_warning_names_its_run_and_how_many_say_it_too(self):
        self.scenario = self.write("says.lua", UNTIL)
        done = self.batch("b", "--vary", "say=omni,stylus", "--repeat", 3, "--jobs", 1)
        rows = self.rows("b")
        lines = [line for line in done.stderr.splitlines() if "driven by nothing" in line]
        self.assertEqual(len(lines), 4, done.stderr)
        for row, line in ((rows[0], lines[0]), (rows[3], lines[1])):
            self.assertTrue(line.startswith(f"warning: run {row['run']} (say={row['say']}, seed {row['seed']}): "), line)
        for row, line in ((rows[0], lines[2]), (rows[3], lines[3])):
            self.assertTrue(line.startswith(f"note: 2 more runs say what run {row['run']} says: "), line)
        self.assertEqual(self.batch("q", "--vary", "say=omni,stylus", "--quiet").stderr, "")


class InEffect(Batches):
    def setUp(self):
        super().setUp()
        self.scenario = self.write("dials.lua", DIALS)

    def test_dials_that_something_overrules_are_not_shown_as_if_they_acted(self):
        self.batch_json("b", "--vary", "hybrid=restore,exact")
        restore, exact = self.rows("b")
        self.assertEqual((restore["integrator"], exact["integrator"]), ("semi-implicit", "implicit"))
        self.assertEqual((restore["duration"], restore["simulated_s"]), ("0.05", "0.05"))
        self.assertEqual(restore["parameter.seed"], "", "the batch gives each run its own")
        self.batch_json("d", "--vary", "hybrid=restore,exact", "--duration", 0.02)
        for row in self.rows("d"):
            self.assertEqual((row["duration"], row["simulated_s"], row["dwell"]), ("", "0.02", "0.05"))
        self.batch_json("v", "--vary", "integrator=semi-implicit,implicit", "--set", "hybrid=exact")
        self.assertEqual([r["integrator"] for r in self.rows("v")], ["semi-implicit", "implicit"], "the design's own words")

    def test_batches_of_other_durations_still_have_the_same_runs(self):
        self.batch_json("b", "--vary", "hybrid=restore,exact")
        self.batch_json("d", "--vary", "hybrid=restore,exact", "--duration", 0.02)
        self.batch_json("e", "--vary", "hybrid=restore,exact", "--duration", 0.03)
        both = json.loads(self.run_program("compare", self.path("d"), self.path("e"), "--json").stdout)
        self.assertEqual((both["only_a"], both["only_b"]), ([], []))
        self.assertNotIn("has no effect", " ".join(both["notes"]))
        report = json.loads(self.run_program("compare", self.path("b"), self.path("d"), "--json").stdout)
        self.assertEqual((report["only_a"], report["only_b"]), ([], []))
        self.assertIn("parameter 'duration' has no effect in B: an option says otherwise", report["notes"])
        self.assertIn("2 runs are in both, with the same parameters and seed", report["notes"])


class Schema(Batches):
    def schema(self, folder):
        db = sqlite3.connect(os.path.join(self.path(folder), "index.sqlite"))
        try:
            return ([row for table in ("run", "timing", "unit", "input", "meta") for row in db.execute(f"PRAGMA table_info({table})")],
                    db.execute("SELECT name, sql FROM sqlite_master WHERE sql IS NOT NULL ORDER BY name").fetchall(),
                    db.execute("SELECT * FROM run").fetchall())
        finally:
            db.close()

    def test_an_index_is_the_same_table_however_it_was_made(self):
        self.scenario = self.write("measures.lua", MEASURES)
        args = ["--vary", "k=1,2,3,4,5,6"]
        self.batch_json("whole", *args, "--jobs", 1)
        self.batch_json("jobs", *args, "--jobs", 6)
        for i in (1, 2, 3):
            self.batch_json(f"s{i}", *args, "--shard", f"{i}/3")
        self.run_json("batch", "merge", self.path("merged"), *(self.path(f"s{i}") for i in (3, 1, 2)))
        whole = self.schema("whole")
        names = [row[1] for row in whole[0]]
        self.assertEqual([n for n in names if n in {"both", "a2", "a4", "a6", *(f"z{i}" for i in range(3, 9))}],
                         ["a2", "a4", "a6", "both", "z3", "z4", "z5", "z6", "z7", "z8"])
        for other in ("jobs", "merged"):
            self.assertEqual(self.schema(other), whole, other)
            self.assertEqual(self.index(other), self.index("whole"), other)
        with self.database(os.path.join(self.path("jobs"), "index.sqlite")) as db:
            for table in ("run", "timing"):
                db.execute(f"DELETE FROM {table} WHERE run IN (0, 3)")
        self.batch_json("jobs", *args)
        self.assertEqual(self.schema("jobs"), whole, "after an interruption")


if __name__ == "__main__":
    unittest.main()
