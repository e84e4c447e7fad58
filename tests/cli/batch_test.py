"""verisim batch: designs, processes, the index. INTERFACES section 5."""
import contextlib
import json
import os
import signal
import sqlite3
import time
import unittest

from batches import LIGHTER, LONG, SANITIZED, Batches, children
from program import SOURCE, VERISIM


class Designs(Batches):
    def test_a_grid_is_what_single_runs_are(self):
        said = self.batch_json("b", "--vary", "speed=0.4,0.5", "--vary", "voxelsize=10mm,0.02", "--repeat", 2)
        self.assertEqual((said["runs"], said["done"], said["failed"]), (8, 8, 0))
        rows = self.rows("b")
        self.assertEqual([int(r["run"]) for r in rows], list(range(8)))
        self.assertEqual([r["speed"] + " " + r["voxelsize"] for r in rows[::2]],
                         ["0.4 0.01", "0.4 0.02", "0.5 0.01", "0.5 0.02"])
        for r in (rows[1], rows[6]):
            one = self.run_json("run", self.scenario, "--set", "speed=" + r["speed"], "--set",
                                "voxelsize=" + r["voxelsize"], "--seed", r["seed"], "-o", self.path("one.h5"))
            self.assertEqual(one["state_hash"], r["state_hash"])
            self.assertEqual(one["outcome"], r["outcome"])
            self.assertEqual(one["frames"], int(r["frames"]))
            self.assertEqual(one["max_force_N"], float(r["max_force_N"]))
            self.assertEqual(one["measures"]["chance"]["value"], float(r["chance"]))

    def test_points_of_a_grid_are_paired_by_seeds_of_batch_and_repetition(self):
        self.batch_json("b", "--vary", "speed=0.4,0.5", "--repeat", 3)
        seeds = [r["seed"] for r in self.rows("b")]
        self.assertEqual(seeds[:3], seeds[3:])
        self.assertEqual(len(set(seeds)), 3)
        self.batch_json("c", "--vary", "voxelsize=0.02", "--repeat", 2, "--seed", 2)
        self.assertNotIn(self.rows("c")[0]["seed"], seeds)

    def test_the_words_may_stand_in_any_order(self):
        words = [["--vary", "speed=0.4,0.5"], ["--set", "bodies=false"], ["--random", "2", "duration=0.01..0.02"],
                 [self.scenario], ["-o", self.path("b")]]
        for turn in range(len(words)):
            order = words[turn:] + words[:turn]
            self.succeed("batch", *[word for part in order for word in part])
        self.assertEqual(len(self.rows("b")), 4)

    def test_a_table_of_runs_with_their_seeds(self):
        self.refuse(3, ["d.csv:3", "fast", "must be a number"], "batch", self.scenario, "-o", self.path("x"), "--design",
                    self.write("d.csv", "speed,seed\n0.4,11\nfast,1\n"))
        design = self.write("d.csv", "speed,seed\n0.4,11\n500mm,18446744073709551615\n")
        self.batch_json("b", "--design", design)
        rows = self.rows("b")
        self.assertEqual([(r["speed"], r["seed"]) for r in rows], [("0.4", "11"), ("0.5", "18446744073709551615")])
        one = self.run_json("run", self.scenario, "--seed", 18446744073709551615, "-o", self.path("one.h5"))
        self.assertEqual(one["state_hash"], rows[1]["state_hash"])

    def test_draws_from_distributions_are_the_same_each_time(self):
        args = ["--random", 4, "speed=0.4..0.5", "voxelsize=zone:H7:25mm", "--repeat", 2, *LIGHTER]
        self.batch_json("b", *args)
        self.batch_json("c", *args, "--jobs", 1)
        self.assertEqual(self.index("b"), self.index("c"))
        rows = self.rows("b")
        self.assertEqual(len(rows), 8)
        self.assertEqual(len({r["speed"] for r in rows}), 4)
        for r in rows:
            self.assertTrue(0.4 <= float(r["speed"]) < 0.5)
            self.assertLess(abs(float(r["voxelsize"]) - 0.0250105), 6 * 3.5e-6)

    def test_the_database_says_units_and_meanings(self):
        self.batch_json("b", "--vary", "speed=0.4,0.5")
        with self.database(os.path.join(self.path("b"), "index.sqlite")) as db:
            units = {c: (u, m) for c, u, m in db.execute("SELECT * FROM unit")}
            columns = [row[1] for row in db.execute("PRAGMA table_info(run)")]
            timing = [row[1] for row in db.execute("PRAGMA table_info(timing)")]
            by_speed = db.execute("SELECT speed, count(*), avg(max_force_N) FROM run WHERE status = 'done' GROUP BY speed")
            self.assertEqual([row[:2] for row in by_speed], [(0.4, 1), (0.5, 1)])
        self.assertEqual(units["speed"], ("m/s", "of the hand"))
        self.assertEqual(units["max_force_N"][0], "N")
        self.assertEqual(units["chance"][0], "1")
        for column in columns + timing:
            self.assertIn(column, units)
        for wanted in ["run", "seed", "status", "error", "outcome", "chance", "insertion_s", "state_hash",
                       "cost.points_tested"]:
            self.assertIn(wanted, columns)
        for wanted in ["wall_s", "load_s", "user_s", "system_s", "frame_ns.p50"]:
            self.assertIn(wanted, timing)
            self.assertNotIn(wanted, columns)
        with open(os.path.join(self.path("b"), "batch.json")) as f:
            manifest = json.load(f)
        for wanted in ["scenario", "scenario_sha256", "design", "seed", "version", "machine"]:
            self.assertIn(wanted, manifest)

    def test_the_summary_lines_up_and_has_intervals(self):
        args = ["--vary", "speed=0.4,0.5", "--repeat", 6, *LIGHTER]
        text = self.batch("b", *args).stdout
        lines = text.splitlines()
        self.assertIn("12 runs: 12 done", lines[0])
        self.assertEqual(len({line.index(w) + len(w) for line, w in zip(lines[1:2], ["mean or share"])}), 1)
        again = self.batch("b", *args).stdout
        self.assertEqual(text, again, "the same digits every time")
        group = self.batch_json("b", *args)["groups"][0]
        self.assertEqual(group["parameters"], {"speed": 0.4})
        self.assertEqual(sum(o["count"] for o in group["outcomes"].values()), 6)
        for outcome in group["outcomes"].values():
            self.assertTrue(0 <= outcome["low"] <= outcome["share"] <= outcome["high"] <= 1)
        chance = group["measures"]["chance"]
        self.assertTrue(chance["low"] <= chance["mean"] <= chance["high"])
        values = [float(r["chance"]) for r in self.rows("b")[:6]]
        self.assertAlmostEqual(chance["mean"], sum(values) / 6, places=14)

    def test_one_run_has_no_interval_of_a_mean(self):
        text = self.batch("b", *LIGHTER).stdout
        self.assertIn(": 1 run: 1 done", text.splitlines()[0])
        self.assertRegex(text, r"chance +1 +0\.\d+ +- +- +1\n")
        chance = self.batch_json("b", *LIGHTER)["groups"][0]["measures"]["chance"]
        self.assertEqual((chance["low"], chance["high"], chance["runs"]), (None, None, 1))

    def test_insertion_and_true_overlap_are_columns(self):
        scenario = os.path.join(SOURCE, "scenarios", "peg_in_hole.lua")
        folder = self.path("pins")
        said = self.run_json("batch", scenario, "-o", folder, "--vary", "clearance=1mm", "--duration", 0.7, "--measure",
                             "--set", "half=true")
        self.assertEqual(said["done"], 1)
        row = self.rows("pins")[0]
        one = self.run_json("run", scenario, "--set", "clearance=1mm", "--set", "half=true", "--duration", 0.7, "--seed",
                            row["seed"], "-o", self.path("one.h5"))
        self.assertEqual(row["state_hash"], one["state_hash"])
        self.assertEqual(row["outcome"], "inserted")
        self.assertTrue(0.1 < float(row["insertion_s"]) < 0.7)
        measured = json.loads(self.succeed("replay", self.path("one.h5"), "--measure", "--json").stdout)["measured"]
        self.assertEqual(float(row["overlap_m"]), max(measured["pairs"][0]["overlap_m"]))
        self.assertEqual(row["overlap_pair"], "block ~ pin")
        self.assertFalse(os.path.exists(os.path.join(folder, "runs")), "nothing is kept")


class Failures(Batches):
    def test_each_way_to_fail_is_a_row(self):
        # 2 s takes the bomb on a busy machine: the limit is the hang's alone.
        args = ["--vary", "misbehave=no,error,bomb,hang,no2", "--time-limit", 8]
        done = self.batch("b", *args, "--json")
        said = json.loads(done.stdout)
        self.assertEqual(done.returncode, 1, "a hang has no answer")
        self.assertEqual((said["done"], said["failed"], said["timeout"], said["memory"]), (2, 1, 1, 1))
        rows = {r["misbehave"]: r for r in self.rows("b")}
        self.assertIn("as it was told", rows["error"]["error"])
        self.assertIn("many.lua:", rows["error"]["error"])
        self.assertIn("of memory", rows["bomb"]["error"])
        self.assertIn("--time-limit", rows["hang"]["error"])
        for word in ["run 1 (misbehave=error", "failed", "timeout", "memory"]:
            self.assertIn(word, done.stderr)
        again = self.batch("b", *args, "--json")
        self.assertEqual(again.returncode, 1)
        self.assertEqual(len(again.stderr.splitlines()), 1, "nothing is done twice")
        self.assertRegex(again.stderr, "^error: .*1 of 5 runs could not be done")

    def test_refused_and_diverged_runs_are_answers(self):
        said = self.batch_json("b", "--vary", "misbehave=no,error,diverge")
        self.assertEqual((said["done"], said["failed"], said["diverged"]), (1, 1, 1))
        row = self.rows("b")[2]
        self.assertEqual((row["status"], row["end"]), ("diverged", "diverged"))
        self.assertIn("not finite", row["error"])

    @unittest.skipIf(SANITIZED, "shadow memory takes terabytes of address space")
    def test_a_run_beyond_the_memory_limit_is_a_row(self):
        said = self.batch_json("b", "--vary", "misbehave=no,huge", "--memory-limit", 500, code=1)
        self.assertEqual((said["done"], said["memory"]), (1, 1), self.rows("b"))
        self.assertIn("memory", self.rows("b")[1]["error"])

    def test_a_library_of_the_cad_program_that_is_not_installed_ends_the_batch(self):
        # None of its runs has an answer, and each has one when the library is there.
        with open(os.path.join(os.path.dirname(VERISIM), "verisim-cad"), "rb") as f:
            program = f.read()
        cad = self.write("cad", program.replace(b"libassimp.so.", b"libassimp.sx."))
        os.chmod(cad, 0o755)
        args = ["--vary", "speed=0.4,0.5", "--no-cache", "--jobs", "2"]
        done = self.batch("b", *args, env={**os.environ, "VERISIM_CAD": cad})
        self.assertEqual(done.returncode, 5, done.stderr)
        self.assertRegex(done.stderr, r"the library libassimp\.sx\.\d+ is not installed; apt install libassimp-dev")
        self.assertEqual(self.batch_json("b", *args)["done"], 2)

    def test_a_cad_program_that_lacks_memory_is_a_row(self):
        cad = self.write("cad", "#!/bin/sh\nexit 127\n")
        os.chmod(cad, 0o755)
        done = self.batch("b", "--no-cache", env={**os.environ, "VERISIM_CAD": cad})
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertEqual([row["status"] for row in self.rows("b")], ["memory"])
        self.assertIn("out of memory", self.rows("b")[0]["error"])

    def test_a_killed_worker_is_a_row_that_says_so(self):
        process = self.start("b", "--vary", "misbehave=no,hang", "--repeat", "2", "--jobs", "2")
        self.wait_for(lambda: self.done("b") == 2)
        for killed in range(2):
            self.wait_for(lambda: children(process.pid))
            os.kill(children(process.pid)[0], signal.SIGKILL)
            self.wait_for(lambda: self.killed("b") == killed + 1)
        _, err = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 1, err)
        rows = self.rows("b")
        self.assertEqual([r["status"] for r in rows], ["done", "done", "failed", "failed"])
        self.assertIn("SIGKILL", rows[3]["error"])

    def test_who_asks_for_the_index_too_early_disturbs_nothing(self):
        # As README's three lines do, in a loop: SQLite makes an empty file where there is none yet.
        for i in range(60 if LONG else 3 if SANITIZED else 10):
            process = self.start(f"b{i}", "--vary", "misbehave=no,no2", "--set", "bodies=false")
            while process.poll() is None:
                with contextlib.suppress(sqlite3.Error), contextlib.closing(
                        sqlite3.connect(os.path.join(self.path(f"b{i}"), "index.sqlite"))) as db:
                    db.execute("SELECT count(*) FROM run").fetchone()
            self.assertEqual(process.returncode, 0, process.communicate()[1])
            process.communicate()
        os.mkdir(self.path("e"))
        with open(os.path.join(self.path("e"), "index.sqlite"), "w"):
            pass
        self.assertEqual(self.batch_json("e", "--set", "bodies=false")["done"], 1)

    def test_kept_run_files_are_those_that_were_asked_for(self):
        args = ["--vary", "misbehave=no,error"]
        self.batch_json("all", *args, "--keep", "all")
        self.assertEqual(sorted(os.listdir(os.path.join(self.path("all"), "runs"))), ["000000.h5"])
        self.assertEqual(self.rows("all")[0]["run_file"], "runs/000000.h5")
        self.succeed("replay", os.path.join(self.path("all"), "runs", "000000.h5"), "--verify")
        self.batch_json("failed", *args, "--keep", "failed")
        self.assertFalse(os.path.exists(os.path.join(self.path("failed"), "runs")))

    def test_workers_end_with_a_killed_batch(self):
        process = self.start("b", "--vary", "misbehave=hang,hang2", "--set", "duration=1e5", "--jobs", "2")
        self.wait_for(lambda: len(children(process.pid)) == 2)
        workers = children(process.pid)
        process.kill()
        process.communicate()
        self.wait_for(lambda: not any(os.path.exists(f"/proc/{w}/exe") for w in workers), 10)

    def test_ctrl_c_ends_workers_and_goes_on_later(self):
        process = self.start("b", "--vary", "misbehave=no,hang")
        self.wait_for(lambda: self.done("b") == 1)
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=30)
        self.assertEqual(process.returncode, 130, err)
        self.assertEqual(self.done("b"), 1)


class BadInput(Batches):
    def test_what_contradicts_itself_is_wrong_usage(self):
        def refused(code, words, *args):
            self.refuse(code, words, "batch", self.scenario, "-o", self.path("b"), *args)
            self.assertFalse(os.path.exists(self.path("b")), "nothing was begun")
        refused(2, "the grid is empty", "--vary", "speed=")
        refused(2, "--repeat 0", "--repeat", 0)
        refused(2, ["--random 0", "the design is empty"], "--random", 0, "speed=1..2")
        refused(2, ["'speed'", "already"], "--vary", "speed=1,2", "--vary", "speed=3")
        refused(2, ["'speed'", "--set speed"], "--vary", "speed=1,2", "--set", "speed=3")
        design = self.write("d.csv", "speed,misbehave\n1,no\n")
        refused(2, ["--vary speed=1,2: 'speed'", "d.csv:1 already"], "--design", design, "--vary", "speed=1,2")
        refused(2, ["--random speed=1..2: 'speed'", "d.csv:1 already"], "--design", design, "--random", 2, "speed=1..2")
        refused(3, ["d.csv:1: 'speed'", "--set speed already"], "--design", design, "--set", "speed=3")
        refused(2, ["one value"], "--vary", "speed=0.5,500mm")
        refused(2, ["--shard 3/2", "1 to N"], "--vary", "speed=1,2", "--shard", "3/2")
        refused(3, ["--vary sped=1: ", "no parameter 'sped'", "did you mean 'speed'", "voxelsize"], "--vary", "sped=1,2")
        refused(3, ["--set sped=1: ", "no parameter 'sped'", "did you mean 'speed'"], "--set", "sped=1")
        refused(3, ["e.csv:2: sped=1: ", "no parameter 'sped'"], "--design", self.write("e.csv", "sped\n1\n"))
        refused(3, ["--vary speed=fast: ", "must be a number"], "--vary", "speed=1,fast")
        refused(3, ["--random sped=1: ", "no parameter 'sped'"], "--random", 3, "sped=1..2")
        refused(2, ["no distribution"], "--random", 3, "speed=gauss")
        refused(2, ["no zone 'Q7'"], "--random", 3, "speed=zone:Q7:25mm")
        refused(3, ["f.csv:3: is the run of line 2 again", "--repeat"], "--design", self.write("f.csv", "speed\n1\n1000mm\n"))
        self.refuse(2, ["--out", "is empty"], "batch", self.scenario, "-o", "")
        refused(2, "--keep", "--keep", "some")
        refused(2, "--time-limit", "--time-limit", "-1")
        begin = time.monotonic()
        values = ",".join(str(i) for i in range(1, 1001))
        refused(2, ["1000000000 runs"], "--vary", "speed=" + values, "--vary", "voxelsize=" + values, "--repeat", 1000)
        refused(2, ["1000000000 runs"], "--random", 1000000000, "speed=1..2")
        refused(2, ["1000000000 not in range", "10000000"], "--repeat", 1000000000)
        self.assertLess(time.monotonic() - begin, 20 if SANITIZED else 5)
        self.refuse(2, "SCENARIO", "batch", "--vary", "speed=1")
        self.refuse(3, "nowhere.lua", "batch", "nowhere.lua", "--vary", "speed=1")

    def test_figures_beyond_all_numbers_are_refused(self):
        for words, args in ((["too wide"], ["--random", 2, "speed=uniform:-1e308:1e308"]),
                            (["beyond all numbers"], ["--random", 2, "speed=normal:1.7e308:1e308"]),
                            (["at most"], ["--vary", "speed=1,2", "--shard", f"3/{2**64 - 1}"])):
            self.refuse(2, words, "batch", self.scenario, "-o", self.path("b"), *args)
        design = self.write("design.csv", 'misbehave\nno\n""\nno\n')
        self.refuse(3, ["design.csv:3", "is empty"], "batch", self.scenario, "-o", self.path("b"), "--design", design)

    def test_warnings_are_told_and_stand_in_the_index(self):
        scenario = self.write("warns.lua", """
            local p = params{k = 1}
            addObject{name = "box", voxelsize = 0.01, Solid.box{0.1, 0.1, 0.1}}
            defineSimulationParameters{duration = 0.05}
            addDevice(Devices.Sensable.PhantomOmni{name = "omni", scale = 1})
            measure("wall_s", p.k, "m")
            Actions.addFrameAction(function() if p.k > 1 then error("no") end end)
            """)
        done = self.run_program("batch", scenario, "--vary", "k=1,2", "--repeat", 3, "-o", self.path("b"))
        self.assertEqual(done.returncode, 0, done.stderr)
        told = [line for line in done.stderr.splitlines() if "'omni' is driven by nothing" in line]
        self.assertEqual(len(told), 2, "once with its run, and once how many more: " + done.stderr)
        self.assertRegex(told[0], r"^warning: run \d \(k=\d, seed \d+\): ")
        self.assertIn("5 more runs say", told[1])
        self.assertRegex(done.stderr, r"run [345] \(k=2, seed \d+\): .*warns.lua:7: no")
        rows = self.rows("b")
        more = int(rows[3]["warnings"]) - int(rows[0]["warnings"])
        self.assertEqual(more, 1)
        self.assertTrue(all("driven by nothing" in row["warning"] for row in rows), rows)
        self.assertEqual([row["measure.wall_s"] for row in rows], ["1"] * 3 + ["2"] * 3, "timing has a wall_s of its own")
        self.assertEqual(self.run_program("batch", scenario, "--vary", "k=1,2", "-o", self.path("q"), "--quiet").stderr, "")

    def test_a_measure_that_changes_its_unit_names_its_run(self):
        scenario = self.write("unit.lua", 'local p = params{unit = "m"} measure("d", 1, p.unit)')
        self.refuse(3, ["run 1 (unit=mm", "measure 'd' has the unit 'm' in one run and 'mm' in another"],
                    "batch", scenario, "--vary", "unit=m,mm", "--jobs", 1, "--duration", "0.01", "-o", self.path("b"))

    def test_a_folder_that_cannot_be_written(self):
        self.write("file", "x")
        for folder in ["/proc/batch", self.path("file"), os.path.join(self.path("file"), "b")]:
            self.refuse(5, ["-o"], "batch", self.scenario, "-o", folder, "--vary", "speed=1")
        os.mkdir(self.path("other"))
        self.write("other/x", "y")
        self.refuse(5, ["other things", "-o"], "batch", self.scenario, "-o", self.path("other"), "--vary", "speed=1")

    def test_parameters_are_listed_with_units_and_meanings(self):
        text = self.succeed("run", self.scenario, "--parameters").stdout
        self.assertRegex(text, r"speed +0\.5 +m/s +of the hand")
        said = self.run_json("run", self.scenario, "--parameters", "--set", "speed=600mm")["parameters"]
        self.assertEqual(said[3], {"name": "speed", "default": 0.6, "unit": "m/s", "meaning": "of the hand"})
        self.assertEqual([p["name"] for p in said], ["bodies", "duration", "misbehave", "speed", "voxelsize"])


if __name__ == "__main__":
    unittest.main()
