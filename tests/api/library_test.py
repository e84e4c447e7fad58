"""The library and the Python module as their users have them: installed, from a folder outside of the source tree."""
import os
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "cli"))
from program import SMALL, SOURCE, VERISIM, ProgramTest  # noqa: E402

BUILD = os.path.dirname(VERISIM)


def must(*command, **options):
    done = subprocess.run(command, capture_output=True, text=True, check=False, **options)
    if done.returncode != 0:
        raise AssertionError(f"{command}: {done.stdout}{done.stderr}")
    return done.stdout


class Installed(ProgramTest):
    @classmethod
    def setUpClass(cls):
        cls.prefix = tempfile.TemporaryDirectory()
        must("cmake", "--install", BUILD, "--prefix", cls.prefix.name)

    @classmethod
    def tearDownClass(cls):
        cls.prefix.cleanup()

    def installed(self, *path):
        return os.path.join(self.prefix.name, *path)

    def plain_run(self, *args):
        return self.run_json("run", self.scenario, *args, "-o", self.path("plain.h5"))

    def setUp(self):
        super().setUp()
        self.scenario = self.write("small.lua", SMALL)

    def test_a_project_finds_it_builds_and_gets_the_programs_bits(self):
        must("cmake", "-S", os.path.join(SOURCE, "tests/api/consumer"), "-B", self.path("build"),
             f"-DCMAKE_PREFIX_PATH={self.prefix.name}", "-DCMAKE_CXX_FLAGS=-Wall -Wextra -Werror")
        must("cmake", "--build", self.path("build"))
        said = must(self.path("build/consumer"), self.scenario, self.path("a.h5")).split()
        plain = self.plain_run("--seed", 7, "--duration", 0.1)
        self.assertEqual(said, [plain["state_hash"], "100", "same"])
        refused = subprocess.run([self.path("build/consumer"), "no.lua", self.path("b.h5")], capture_output=True,
                                 text=True, check=False)
        self.assertEqual(refused.returncode, 3)
        self.assertIn("no.lua", refused.stdout)

    def readme_example(self, begin):
        """The code of README that begins so."""
        with open(os.path.join(SOURCE, "README.md"), encoding="utf-8") as f:
            return f.read().split("```" + begin, 1)[1].split("```", 1)[0]

    def test_the_readmes_examples_work(self):
        os.symlink(os.path.join(SOURCE, "scenarios"), self.path("scenarios"))
        text = self.readme_example("python\nimport verisim").replace("repeat=20", "repeat=1, duration=1")
        said = self.python("import verisim" + text).splitlines()
        self.assertEqual(said[0].split()[0], "inserted")
        self.assertIn("max_force_N", said[-1])
        self.write("main.cpp", self.readme_example("cpp\n"))
        self.write("CMakeLists.txt", "cmake_minimum_required(VERSION 3.25)\nproject(mine CXX)\nfind_package(verisim REQUIRED)\n"
                   "add_executable(mine main.cpp)\ntarget_link_libraries(mine verisim::verisim)\n")
        must("cmake", "-S", self.folder, "-B", self.path("build"), f"-DCMAKE_PREFIX_PATH={self.prefix.name}")
        must("cmake", "--build", self.path("build"))
        said = must(self.path("build/mine"), cwd=self.folder)
        plain = self.run_json("run", os.path.join(SOURCE, "scenarios/peg_in_hole.lua"), "--set", "clearance=1mm", "--seed", 7,
                              "-o", self.path("p.h5"))
        self.assertIn(f"inserted {plain['state_hash']}, at last at z = ", said)

    def test_public_headers_need_nothing_but_the_standard_library(self):
        for name in os.listdir(self.installed("include/verisim")):
            source = self.write("a.cpp", f"#include <verisim/{name}>\n")
            must("c++", "-std=c++20", "-Wall", "-Wextra", "-Werror", "-fsyntax-only", "-I", self.installed("include"),
                 source)

    def test_the_library_shows_what_its_headers_declare_and_leaves_the_hosts_memory_alone(self):
        shown = must("nm", "-DC", "--defined-only", self.installed("lib/libverisim.so")).splitlines()
        functions = {line.split(" ", 2)[2].split("(")[0].split("[")[0] for line in shown if line.split()[1] == "T"}
        owners = {name.removeprefix("verisim::").split("::")[0] for name in functions}
        self.assertEqual(owners, {"Frame", "Run", "Values", "run", "version"})
        self.assertFalse([line for line in shown if "operator new" in line])

    def test_the_installed_program_finds_the_cad_program_and_the_scenarios(self):
        program, scenarios = self.installed("bin/verisim"), self.installed("share/verisim/scenarios")
        must(program, "run", os.path.join(scenarios, "peg_in_hole_step.lua"), "--duration", "0.05", "--no-cache", "-o",
             self.path("step.h5"), env={"PATH": os.environ["PATH"]})
        must(program, "reproduce", "--only", "R1", "--quick", "-o", self.path("r"), cwd=self.folder)

    @unittest.skipUnless(os.path.exists(os.path.join(BUILD, "verisim-avr")), "verisim-avr is not built")
    def test_the_installed_program_and_module_run_the_robots_machine_code(self):
        scene = self.installed("share/verisim/scenarios/robot_gain.lua")
        must(self.installed("bin/verisim"), "run", scene, "--set", "board=avr", "--duration", "0.05", "-o", self.path("a.h5"),
             env={"PATH": os.environ["PATH"]})
        said = self.python(f"""
import verisim
run = verisim.run({scene!r}, board="avr", duration=0.05, out="b.h5")
print(run["cost/robot/robot/busy_cycles"][-1] == verisim.Run("a.h5")["cost/robot/robot/busy_cycles"][-1] > 0)
""")
        self.assertEqual(said, "True\n")

    def python(self, text, **options):
        """What a Python of Debian prints that has nothing but the installed module."""
        env = dict(os.environ, PYTHONPATH=self.installed("lib/python3/dist-packages"))
        return must("/usr/bin/python3", "-c", text, cwd=self.folder, env=env, **options)

    def test_the_python_module_gets_the_programs_bits(self):
        said = self.python("""
import verisim
run = verisim.run("small.lua", seed=7, duration=0.1)
print(run.figures["state_hash"], run["state/body/box/pose"].shape, run.parameters["voxelsize"])
""").split(" ", 1)
        plain = self.plain_run("--seed", 7, "--duration", 0.1)
        self.assertEqual(said[0], plain["state_hash"])
        self.assertEqual(said[1].strip(), "(100, 7) 0.01")

    def test_a_batch_from_python(self):
        said = self.python("""
import verisim
batch = verisim.batch("small.lua", "b", vary={"voxelsize": [0.01, "20mm"]}, repeat=2, duration=0.05)
table = batch.to_pandas()
print(len(table), batch.groups[0]["runs"], table.voxelsize.tolist())
try:
    verisim.batch("small.lua", "c", vary={"voxelsiez": [1]})
except verisim.Failure as failure:
    print(failure)
""").splitlines()
        self.assertEqual(said[0], "4 2 [0.01, 0.01, 0.02, 0.02]")
        self.assertIn("voxelsize", said[1])


if __name__ == "__main__":
    unittest.main()
