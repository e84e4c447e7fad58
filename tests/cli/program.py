"""The program under test, and a folder of its own for each test."""
import json
import math
import os
import shutil
import subprocess
import tempfile
import unittest

import numpy as np

VERISIM = os.environ["VERISIM"]
SOURCE = os.environ["VERISIM_SOURCE_DIR"]
SHARED = os.environ["VERISIM_SHARED_DATA"]

# A scene that loads at once: no CAD kernel in it but two boxes, nobody waits for it.
SMALL = """
local p = params{ voxelsize = 0.01, duration = 0.3, speed = 0.5, word = "a" }
defineSimulationParameters{ duration = p.duration }
addObject{ name = "plate", fixed = true, voxelsize = p.voxelsize, Solid.box{0.3, 0.3, 0.02} }
local box = addObject{ name = "box", voxelsize = p.voxelsize, position = {0, 0, 0.05}, Solid.box{0.06, 0.06, 0.04} }
local hand = Devices.Hand{ name = "hand", path = {
  {position = {0, 0, 0.05}}, {position = {0, 0, 0.02}, speed = p.speed}, {position = {0.05, 0, 0.02}, speed = p.speed} } }
addDevice(hand)
grasp(hand, box)
"""


def dense(f, first, second, fact):
    """What a pair of bodies recorded, a row per frame: zeros where they were not near. As the README says."""
    pairs = [(p["first"].decode(), p["second"].decode()) for p in f["state/pairs"]]
    column = f["state/links"][fact]
    values = np.zeros((len(f["state/time"]), *column.shape[1:]), column.dtype)
    if (first, second) in pairs:
        rows = f["state/links/pair"][()] == pairs.index((first, second))
        values[f["state/links/frame"][()][rows]] = column[()][rows]
    return values


def turned_stl(inner, outer, height, sides=96):
    """ASCII STL of a solid of revolution about z, centred: a rod (inner = 0) or a bush. Lengths in mm."""
    def ring(radius, z):
        return [(radius * math.cos(2 * math.pi * i / sides), radius * math.sin(2 * math.pi * i / sides), z)
                for i in range(sides)]
    walls = [(ring(outer, -height / 2), ring(outer, height / 2)), (ring(outer, height / 2), ring(inner, height / 2)),
             (ring(inner, height / 2), ring(inner, -height / 2)), (ring(inner, -height / 2), ring(outer, -height / 2))]
    text = ["solid turned"]
    for a, b in walls:
        for i in range(sides):
            j = (i + 1) % sides
            for corners in ((a[i], a[j], b[j]), (a[i], b[j], b[i])):
                if len(set(corners)) < 3:
                    continue
                text += ["facet normal 0 0 0", "outer loop"]
                text += ["vertex {:.9g} {:.9g} {:.9g}".format(*p) for p in corners]
                text += ["endloop", "endfacet"]
    return "\n".join(text + ["endsolid turned", ""])


class ProgramTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="verisim-test-")
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def path(self, name):
        return os.path.join(self.folder, name)

    def write(self, name, content):
        with open(self.path(name), "wb" if isinstance(content, bytes) else "w") as f:
            f.write(content)
        return self.path(name)

    PATIENCE = 300  # s, for one program

    def run_program(self, *args, **options):
        options.setdefault("timeout", self.PATIENCE)
        return subprocess.run([VERISIM, *map(str, args)], capture_output=True, text=True, cwd=self.folder, **options)

    def succeed(self, *args, **options):
        done = self.run_program(*args, **options)
        self.assertEqual(done.returncode, 0, f"{args}: {done.stderr}")
        return done

    def run_json(self, *args):
        return json.loads(self.succeed(*args, "--json").stdout)

    def refuse(self, code, words, *args, **options):
        """The program ends with this exit code and one line on stderr that has all the words in it."""
        done = self.run_program(*args, **options)
        text = done.stderr.strip()
        self.assertEqual(done.returncode, code, f"{args}: {text}")
        errors = [line for line in text.splitlines() if line.startswith("error: ")]
        self.assertEqual(len(errors), 1, f"{args}: {text}")
        for word in [words] if isinstance(words, str) else words:
            self.assertIn(word, errors[0])
        self.assertEqual(done.stdout, "", f"{args}: nothing may look like a result")
        return errors[0]

    def small_run(self, *args, script=SMALL):
        """Runs the small scene; returns its run file and summary."""
        scenario = self.write("small.lua", script)
        run_file = self.path("small.h5")
        return run_file, self.run_json("run", scenario, "-o", run_file, *args)
