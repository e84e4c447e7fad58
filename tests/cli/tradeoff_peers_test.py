"""verisim tradeoff --peers: other people's engines beside this project's methods."""
import csv
import json
import os
import shutil
import subprocess
import unittest

from program import SHARED, SOURCE, VERISIM, ProgramTest
from tradeoff_test import PUSHED

PEERS = os.path.join(os.path.dirname(VERISIM), "verisim-peers")
POSES = os.path.join(os.path.dirname(SHARED), "reference", "peers", "peg_poses.csv")
OURS = ["Verisim off", "Verisim restore", "Verisim exact"]
THEIRS = ["MuJoCo", "Bullet", "ODE", "FCL"]


def why_not():
    if not os.path.exists(PEERS):
        return "verisim-peers is not built: it needs libmujoco-dev libbullet-dev libode-dev, and ninja -C build verisim-peers"
    return None


@unittest.skipIf(why_not() is not None, why_not())
class Peers(ProgramTest):
    def test_ours_and_theirs_stand_in_one_table_of_the_same_poses_and_insertions(self):
        done = self.succeed("tradeoff", "--peers", "--quick", "-o", "out", "--json", timeout=550)
        table = json.loads(done.stdout)
        with open(self.path("out/tradeoff.json")) as f:
            self.assertEqual(json.load(f), table)
        self.assertEqual((table["format"], table["rows"]), ("verisim-tradeoff", []))
        rows = {row["name"]: row for row in table["peers"]}
        self.assertEqual(list(rows), OURS + THEIRS)
        for name in THEIRS:
            if "missing" in rows[name]:
                self.assertTrue(rows[name]["missing"].startswith("lib"))
        there = [row for row in table["peers"] if "missing" not in row]
        depths = []  # without the file verisim-peers draws the poses
        if os.path.exists(POSES):
            with open(POSES) as f:
                depths = [float(row["depth"]) for row in csv.DictReader(line for line in f if line[0] != "#")]
        insertions = None
        for row in there:
            self.assertTrue(row["version"], row["name"])
            for what in ("poses", "insertion"):
                best = row[what]
                if best is None:  # contacts of `restore` are those of `off`: it has no query of its own
                    self.assertEqual((row["name"], what), ("Verisim restore", "poses"))
                    continue
                self.assertEqual(best["setting"], row["setting"][what])
                self.assertIn(best, row["searched"][what])
                time = best["query_us" if what == "poses" else "step_us"]
                self.assertTrue(0 < time["low"] <= time["median"] <= time["high"], time)
            for p in row["searched"]["poses"]:
                self.assertEqual(p["poses"], len(depths) or 1000)
                if not depths:
                    continue
                # No more can be missed than penetrate, nor imagined than are clear: the truth is that of the file.
                self.assertLessEqual(p["missed"] * len(depths), sum(d > 1e-5 for d in depths) + 1e-6)
                self.assertLessEqual(p["imagined"] * len(depths), sum(d <= 0 for d in depths) + 1e-6)
            for i in row["searched"]["insertion"]:
                tasks = [(t["clearance_m"], t["start"]) for t in i["trials"]]
                insertions = insertions or tasks
                self.assertEqual(tasks, insertions)
                self.assertEqual(i["passed"], sum(t["passed"] for t in i["trials"]))
        # No setting that was tried passes more often than the best of its engine.
        for row in there:
            self.assertEqual(row["insertion"]["passed"], max(i["passed"] for i in row["searched"]["insertion"]))
        # The truths are closed forms of poses, and `exact` computes none of them: it meets all three.
        exact = rows["Verisim exact"]
        self.assertEqual((exact["poses"]["missed"], exact["poses"]["imagined"]), (0, 0))
        self.assertLess(exact["poses"]["depth_error_m"]["p95"], 1e-6)
        self.assertLess(exact["insertion"]["overlap_of_clearance"], 0.01)
        self.assertLess(exact["insertion"]["force_error_N"], 0.01)


class WithoutPeers(ProgramTest):
    """The program in a folder of its own."""

    def alone(self, *args):
        program = self.path("verisim")
        if not os.path.exists(program):
            shutil.copy(VERISIM, program)
        environment = {**os.environ, "VERISIM_CAD": os.path.join(os.path.dirname(VERISIM), "verisim-cad")}
        return subprocess.run([program, "tradeoff", *args], capture_output=True, text=True, cwd=self.folder, timeout=120,
                              env=environment)

    def refuse_alone(self, words, *args):
        done = self.alone(*args)
        self.assertEqual((done.returncode, done.stdout), (3, ""), done.stderr)
        errors = done.stderr.strip().splitlines()
        self.assertEqual(len(errors), 1, done.stderr)
        for word in words:
            self.assertIn(word, errors[0])

    def test_where_it_is_not_built_the_command_says_what_to_install_before_anything_runs(self):
        words = ["error: --peers: verisim-peers is not beside this program", "libmujoco-dev libbullet-dev libode-dev",
                 "ninja -C build verisim-peers"]
        self.refuse_alone(words, "--peers")
        scenario = os.path.join(SOURCE, "scenarios", "peg_in_hole.lua")
        self.refuse_alone(words, scenario, "--vary", "hybrid=off,exact", "--peers")
        self.assertNotIn("out", os.listdir(self.folder))

    def play(self, script):
        path = self.write("verisim-peers", "#!/bin/sh\n" + script)
        os.chmod(path, 0o755)

    def test_a_program_that_fails_or_says_something_else_is_an_error(self):
        self.play("exit 3\n")
        self.refuse_alone(["ended with exit code 3"], "--peers")
        self.play("kill -9 $$\n")
        self.refuse_alone(["ended by signal 9"], "--peers")
        for said in ("", "nothing", '{"format": "verisim-peers", "format_version": 2, "commit": "", "peers": []}',
                     '{"format": "verisim-peers", "format_version": 1, "commit": 1, "peers": []}'):
            self.play(f"echo '{said}'\n")
            self.refuse_alone(["build it again"], "--peers")
        self.play("""echo '{"format": "verisim-peers", "format_version": 1, "commit": "", "peers": [{"name": "a"}]}'\n""")
        self.refuse_alone(["no list of engines"], "--peers")

    def test_an_engine_that_is_missing_is_a_row_that_names_its_package(self):
        self.play("""echo '{"format": "verisim-peers", "format_version": 1, "commit": "another", "peers": """
                  """[{"name": "ODE", "version": null, "missing": "libode-dev"}]}'\n""")
        done = self.alone("--peers")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("ODE: not there when verisim-peers was built; apt install libode-dev", done.stdout)
        self.assertIn("note: verisim-peers was built from commit another", done.stdout)

    def test_with_a_scenario_they_stand_behind_its_settings(self):
        self.play("""echo '{"format": "verisim-peers", "format_version": 1, "commit": "another", "peers": """
                  """[{"name": "ODE", "version": null, "missing": "libode-dev"}]}'\n""")
        self.write("pushed.lua", PUSHED)
        done = self.alone("pushed.lua", "--vary", "hybrid=off,exact", "--repeat", "1", "--peers", "-o", "out")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertLess(done.stdout.index("front by"), done.stdout.index("ODE: not there"))
        with open(self.path("out/tradeoff.json")) as f:
            table = json.load(f)
        self.assertEqual((len(table["rows"]), table["peers"][0]["missing"]), (2, "libode-dev"))
        self.assertTrue(any("another" in note for note in table["notes"]))

    def test_what_needs_a_scenario_is_refused_without_one(self):
        for args in ((), ("--vary", "hybrid=off,exact")):
            self.refuse(2, "SCENARIO is required", "tradeoff", *args)
        for option, value in (("--vary", "hybrid=off,exact"), ("--budget", "20us"), ("--error", "1N"), ("--set", "a=1"),
                              ("--duration", "1"), ("--by", "force")):
            self.refuse(2, "are of a SCENARIO", "tradeoff", "--peers", option, value)
        self.refuse(2, "--peers", "tradeoff", os.path.join(SOURCE, "scenarios", "peg_in_hole.lua"), "--quick")


if __name__ == "__main__":
    unittest.main()
