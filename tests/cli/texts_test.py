"""Hostile texts: names, outcomes, events, values and arguments are refused where they enter or escaped; no run is lost, and
--json is one valid object."""
import json
import os
import subprocess
import unittest

import h5py

from program import ProgramTest, VERISIM, turned_stl

# Two boxes, nothing else: every case loads it anew.
SCENE = """
addObject{ name = "plate", fixed = true, voxelsize = 0.01, Solid.box{0.1, 0.1, 0.02} }
addObject{ name = "box", voxelsize = 0.01, position = {0, 0, 0.05}, Solid.box{0.04, 0.04, 0.04} }
"""

# Text as Lua writes it; is it fit to be a name?
NAMES = [(r'"\27[31mred"', False), (r'"a\nb"', False), (r'"\0"', False), (r'"a\0b"', False), (r'"\255\254"', False),
         (r'"\192\128"', False), (r'"\194\155"', False), (r'("x"):rep(1000000)', False), (r'"quo\"te"', True),
         (r'"back\\slash"', True), ('"größe"', True), (r"'it\'s'", True), ('"</script>"', True), ('"a/b~c"', True)]


class HostileTexts(ProgramTest):
    def run_script(self, script, *options):
        out = self.path("it.h5")
        if os.path.exists(out):
            os.remove(out)
        done = subprocess.run([VERISIM, "run", self.write("it.lua", script), "-o", out, "--duration", "0.02", "--json",
                               *options], capture_output=True, timeout=120)
        return done, out

    def check(self, script, fit, *options):
        """Refused in one line, or a whole run whose JSON and run file can be read."""
        done, out = self.run_script(script, *options)
        error = done.stderr.decode("utf-8")  # strictly
        self.assertNotIn("\x1b", error)
        if not fit:
            self.assertEqual(done.returncode, 3, (script[-200:], error))
            self.assertEqual(error.count("\n"), 1, error)
            self.assertTrue(error.startswith("error: it.lua:"), error)
            return
        self.assertEqual(done.returncode, 0, (script[-200:], error))
        figures = json.loads(done.stdout.decode("utf-8"))
        with h5py.File(out) as run:
            self.assertEqual(json.loads(run["summary"].attrs["json"]), figures)
            json.loads(run.attrs["parameters"])
            run["events"][:]
        self.assertEqual(subprocess.run([VERISIM, "replay", out, "--verify"], capture_output=True).returncode, 0)

    def test_names_in_every_place(self):
        places = ['outcome({})', 'measure({}, 1, "N")', 'measure("a", 1, {})', 'event({}, "text")']
        hand = 'addDevice(Devices.Hand{{ name = {}, path = {{{{0, 0, 0}}, {{0, 0, 0.1}}}} }})'
        for text, fit in NAMES:
            with self.subTest(text=text):
                # A device's name is a folder of the run file.
                words = [place.format(text) for place in (places if "/" in text else places + [hand])]
                for word in ["\n".join(words)] if fit else words:
                    self.check(SCENE + "\n" + word, fit)

    def test_names_of_bodies_and_parameters(self):
        for text, fit in NAMES:
            with self.subTest(text=text):
                self.check(SCENE.replace('name = "plate"', f"name = {text}"), fit)
                self.check("params{ [" + text + "] = 1 }\n" + SCENE, fit)

    def test_what_is_said_is_escaped(self):
        for text, _ in NAMES:
            with self.subTest(text=text):
                self.check(SCENE + f'\nevent("kind", {text}) print({text}) runbuf:addString({text})', True)
                done, _ = self.run_script(SCENE + f"\nerror({text})")
                error = done.stderr.decode("utf-8")
                self.assertEqual(done.returncode, 3)
                self.assertEqual((error.count("\n"), "\x1b" in error), (1, False), error[:300])

    def test_parameter_values(self):
        for text, fit in [('"a\\nb"', True), ('"\\0"', False), ('"\\255"', False), ('("x"):rep(1e6)', False)]:
            self.check("params{ value = " + text + " }\n" + SCENE, fit)

    def test_arguments_are_lines_of_utf8(self):
        script = self.write("it.lua", 'params{ text = "x", number = 1 }\n' + SCENE)
        for argument in [b"text=a\nb", b"number=1\n+1", b"text=\xff", b"text=\x1b[31m", b"number=\xc2\x9b"]:
            for option in [b"--set", b"--bind", b"-o", b"--seed"]:
                done = subprocess.run([VERISIM.encode(), b"run", script.encode(), option, argument], capture_output=True)
                error = done.stderr.decode("utf-8")
                self.assertEqual(done.returncode, 2, error)
                self.assertEqual((error.count("\n"), "\x1b" in error), (1, False), error)
        done = subprocess.run([VERISIM.encode(), b"run", b"missing\xff.lua"], capture_output=True)
        self.assertEqual((done.returncode, done.stderr.decode().count("\n")), (2, 1))

    def test_an_error_of_a_set_value_is_one_line(self):
        script = self.write("it.lua", "params{ number = 1 }\n" + SCENE)
        self.refuse(3, "--set number=", "run", script, "--set", "number=)(", "-o", self.path("x.h5"))
        self.refuse(3, "text", "run", script, "--set", "number='a\\nb'", "-o", self.path("x.h5"))
        self.refuse(3, "broken", "run", script, "--set", "number=error('broken\\nline')", "-o", self.path("x.h5"))

    def test_what_every_command_says_of_files_of_hostile_names_and_contents(self):
        folder = self.path('it\'s "a" \\ b')
        os.mkdir(folder)
        names = {name: os.path.join(folder, name) for name in ("it.lua", "it.h5", "it.csv", "it.stl")}
        with open(names["it.lua"], "w") as f:
            f.write(SCENE)
        with open(names["it.csv"], "wb") as f:
            f.write(b"# verisim-trace 1\n# kind: input\n# rate_hz: 100\n# source: \x1b[31mred \"\\\n"
                    b't,"q\\\x1b[31m\n0,1\n0.01,2\n')
        with open(names["it.stl"], "w") as f:
            f.write(turned_stl(0, 10, 20, 8).replace("solid turned", 'solid "q\\\x1b[31m', 1))
        commands = [("run", names["it.lua"], "-o", names["it.h5"], "--duration", "0.01"), ("replay", names["it.h5"]),
                    ("replay", names["it.h5"], "--verify"), ("trace", "info", names["it.csv"]),
                    ("inspect", names["it.stl"]), ("doctor",)]
        for command in commands:
            said = self.run_program(*command)
            self.assertNotIn("\x1b", said.stdout + said.stderr, command)
            done = self.run_program(*command, "--json")
            self.assertNotIn("\x1b", done.stdout + done.stderr, command)
            if done.returncode == 0:
                json.loads(done.stdout)
            else:  # a name that is refused
                self.assertEqual((done.returncode, done.stdout, done.stderr.count("\n")), (3, "", 1), command)
        with h5py.File(names["it.h5"], "r+") as f:
            f.attrs["version"] = 'red \x1b[31m "'
        done = self.run_program("replay", names["it.h5"])
        self.assertIn("notice: written by verisim red", done.stderr)
        self.assertNotIn("\x1b", done.stderr)


if __name__ == "__main__":
    unittest.main()
