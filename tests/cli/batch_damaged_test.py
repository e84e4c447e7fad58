"""A batch's folder that was damaged, forged or whose files were changed: refused with its name, never a raw text."""
import json
import os
import random
import shutil
import sqlite3
import unittest

from batches import LIGHT, SANITIZED, Batches
from program import SOURCE

DESIGN = ["--vary", "speed=0.4,0.5", *LIGHT]


class Damaged(Batches):
    def setUp(self):
        super().setUp()
        self.batch("b", *DESIGN)

    def look(self, what, may_be_whole=False):
        """All that reads the damaged folder `d`: refused with exit code 3 and one line, or not disturbed by it."""
        refused = 0
        for args in (["batch", self.scenario, "-o", self.path("d"), *DESIGN],
                     ["batch", "merge", self.path("m"), self.path("d")],
                     ["compare", self.path("d"), self.path("b")]):
            done = self.run_program(*args)
            self.assertIn(done.returncode, (0, 1, 3), (what, args, done.stderr))
            self.assertNotIn("exception", done.stderr, (what, args))
            if done.returncode == 3:
                refused += 1
                self.assertRegex(done.stderr, r"^error: .+\n$", (what, args))
                self.assertEqual(done.stderr.count("\n"), 1, (what, args, done.stderr))
                self.assertIn(self.path("d"), done.stderr, (what, args))
            shutil.rmtree(self.path("m"), ignore_errors=True)
        if not may_be_whole:
            self.assertGreater(refused, 0, what)

    def copy(self):
        shutil.rmtree(self.path("d"), ignore_errors=True)
        shutil.copytree(self.path("b"), self.path("d"))
        return self.path("d/index.sqlite")

    def test_an_index(self):
        with open(self.path("b/index.sqlite"), "rb") as f:
            whole = f.read()
        draw = random.Random(1)
        for content in [draw.randbytes(20000), whole[:100], whole[:4096], whole[:-4096], b"SQLite format 3\0" + whole[300:]]:
            with open(self.copy(), "wb") as f:
                f.write(content)
            self.look(f"{len(content)} bytes")
        statements = [f"DROP TABLE {table}" for table in ("run", "timing", "unit", "input", "meta")]
        statements += [f"PRAGMA user_version = {version}" for version in (0, 2)]
        statements += [f"UPDATE meta SET value = '{value}' WHERE name = 'layout'"
                       for value in ("", "{}", "[]", '{"parameters":[{}],"figures":[],"timing":[]}')]
        statements += ["DELETE FROM meta", "ALTER TABLE run DROP COLUMN status", "ALTER TABLE timing DROP COLUMN answered"]
        statements += ["UPDATE run SET status = 'x'", "UPDATE run SET status = NULL", "DELETE FROM timing", "INSERT INTO run (run, status) VALUES (77, 'done')",
                       "ALTER TABLE run DROP COLUMN outcome"]
        for statement in statements[::4] if SANITIZED else statements:
            connection = sqlite3.connect(self.copy())
            connection.execute(statement)
            connection.commit()
            connection.close()
            self.look(statement)

    def test_what_the_folder_says_of_itself(self):
        with open(self.path("b/batch.json")) as f:
            whole = json.load(f)
        texts = ["", "{", "[]", "null", "x"]
        for member in whole:
            left_out = {k: v for k, v in whole.items() if k != member}
            texts += [json.dumps(left_out)]
            texts += [json.dumps({**whole, member: value}) for value in (None, -1, "x", [1], {}, {"x": {}})]
        for text in texts[::9] if SANITIZED else texts:
            self.copy()
            with open(self.path("d/batch.json"), "w") as f:
                f.write(text)
            self.look(text, may_be_whole=True)  # the machine and the scenario's place may be others

    def test_an_index_without_its_design_is_no_other_designs(self):
        args = ["--vary", "speed=0.4,0.5", *LIGHT]
        self.batch_json("b", *args)
        before = self.index("b")
        manifest = os.path.join(self.path("b"), "batch.json")
        os.rename(manifest, self.path("batch.json"))
        for vary in ("speed=0.4,0.5", "speed=0.6,0.7"):
            self.refuse(3, ["has an index and no batch.json", "-o"], "batch", self.scenario, "-o", self.path("b"), "--vary", vary, *LIGHT)
        self.batch_json("s", *args, "--shard", "1/1")
        self.refuse(3, ["has an index and no batch.json"], "batch", "merge", self.path("b"), self.path("s"))
        os.rename(self.path("batch.json"), manifest)
        self.assertEqual(self.batch_json("b", *args)["done"], 2)
        self.assertEqual(self.index("b"), before)

    def test_what_is_wrong_in_batch_json_is_named(self):
        for text, words in (('{\n"format": "verisim-batch",\n]', "batch.json:3: is no JSON, or the file ends there"),
                            (lambda whole: {**whole, "runs": "x"}, "batch.json: 'runs' is missing or not what it should be"),
                            (lambda whole: {k: v for k, v in whole.items() if k != "groups"}, "'groups' is missing"),
                            (lambda whole: {**whole, "design": {**whole["design"], "vary": [{"parameter": 7}]}}, "another design")):
            self.copy()
            if callable(text):
                with open(self.path("b/batch.json")) as f:
                    text = json.dumps(text(json.load(f)))
            self.write("d/batch.json", text)
            self.refuse(3, [words], "batch", self.scenario, "-o", self.path("d"), *DESIGN)

    def test_a_file_that_a_finished_batch_read(self):
        with open(self.scenario) as f:
            text = f.read()
        self.write("of_many.lua", "return 1")
        self.write("many.lua", "require 'of_many'\n" + text)
        self.batch("r", *DESIGN)
        self.assertEqual(self.batch("r", *DESIGN).returncode, 0)
        self.write("of_many.lua", "return 2")
        done = self.batch("r", *DESIGN)
        self.assertEqual((done.returncode, done.stdout), (3, ""))
        self.assertRegex(done.stderr, "^error: of_many.lua: was changed since the batch began")
        os.remove(self.path("of_many.lua"))
        self.assertRegex(self.batch("r", *DESIGN).stderr, "^error: .*there is no module 'of_many'")

    def test_runs_that_were_done_before_cannot_be_kept(self):
        done = self.batch("b", *DESIGN, "--keep", "all")
        self.assertEqual(done.returncode, 0)
        self.assertRegex(done.stderr, "^note: .*2 of the runs that were done before have no run file")
        self.assertEqual(self.batch("b", *DESIGN, "--keep", "failed").stderr, "")
        self.batch("k", *DESIGN, "--keep", "all")
        self.assertEqual(self.batch("k", *DESIGN, "--keep", "all").stderr, "")


    def test_it_is_read_where_nothing_can_be_written(self):
        self.assertFalse(os.path.exists(self.path("b/index.sqlite-wal")))
        with open(self.path("b/index.sqlite"), "rb") as f:
            self.assertEqual(f.read(20)[18:], b"\1\1", "no log is needed to read it")

    @unittest.skipIf(SANITIZED, "shadow memory takes terabytes of address space")
    def test_want_of_memory_is_no_fault_of_the_model(self):
        scenario = os.path.join(SOURCE, "scenarios", "peg_in_hole.lua")
        for limit in (30, 50, 70):
            done = self.run_program("batch", scenario, "-o", self.path(f"m{limit}"), "--duration", 0.01, "--memory-limit", limit,
                                    "--no-cache", "--json")
            self.assertEqual(done.returncode, 1, (limit, done.stdout, done.stderr))
            self.assertEqual(json.loads(done.stdout)["memory"], 1, (limit, done.stderr))
            self.assertIn("--memory-limit", done.stderr)


class Texts(Batches):
    def test_a_value_with_lines_does_not_break_the_table(self):
        self.write("d.csv", 'misbehave,speed\n"x\ny",1\n"x\tz",2\n')
        done = self.batch("b", "--design", self.path("d.csv"), *LIGHT)
        lines = [line for line in done.stdout.splitlines() if "heads" in line or "tails" in line]
        self.assertEqual(len(lines), 2, done.stdout)
        self.assertIn("x\\ny", lines[0])
        self.assertIn("x\\tz", lines[1])
        self.assertEqual(lines[0].index("1  "), lines[1].index("2  "))

    def test_a_column_seed_is_not_taken_for_what_it_may_not_be(self):
        self.write("s.lua", "local p = params{ seed = 3 }\ndefineSimulationParameters{ duration = 0.01 }\n")
        self.write("d.csv", "seed\n5\n")
        done = self.run_program("batch", self.path("s.lua"), "--design", self.path("d.csv"), "-o", self.path("b"))
        self.assertEqual(done.returncode, 3)
        self.assertIn("d.csv:1: 'seed' may be the runs' seed or the scenario's parameter", done.stderr)

    def test_advice_is_of_what_happened(self):
        done = self.batch("b", "--vary", "misbehave=no,hang", "--time-limit", 1, *LIGHT)
        self.assertIn("--time-limit", done.stderr.splitlines()[-1])
        self.assertNotIn("--memory-limit", done.stderr.splitlines()[-1])
        done = self.batch("c", "--repeat", -1)
        self.assertEqual(done.returncode, 2)
        self.assertIn("--repeat", done.stderr)
        self.assertNotIn("18446744073709551616", done.stderr)


if __name__ == "__main__":
    unittest.main()
