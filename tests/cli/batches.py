"""What the tests of verisim batch share: a scenario that misbehaves on request, folders, indices."""
import contextlib
import csv
import json
import os
import sqlite3
import subprocess
import time

from program import VERISIM, ProgramTest

LONG = "VERISIM_LONG_TESTS" in os.environ
SANITIZED = os.environ.get("VERISIM_SANITIZE", "") != ""

# As SMALL, and it can misbehave; its outcome needs the seed. Without bodies a run takes milliseconds.
MANY = """
local p = params{ voxelsize = 0.01, duration = 0.05, misbehave = "no", bodies = true,
                  speed = parameter(0.5, "m/s", "of the hand") }
if p.misbehave == "error" then error("as it was told") end
if p.misbehave == "bomb" then local t = {} for i = 1, 1e8 do t[i] = {} end end
if p.misbehave == "huge" then p.voxelsize = 6e-5 end
defineSimulationParameters{ duration = p.misbehave == "hang" and 1e5 or p.duration,
                            gravity = {0, 0, p.misbehave == "diverge" and -1e308 or 0}, allBodiesAreDynamic = true }
if p.bodies then
  addObject{ name = "plate", fixed = true, voxelsize = p.voxelsize, Solid.box{0.3, 0.3, 0.02} }
  local box = addObject{ name = "box", voxelsize = p.voxelsize, position = {0, 0, p.misbehave == "huge" and 0.031 or 0.05}, Solid.box{0.06, 0.06, 0.04} }
  local hand = Devices.Hand{ name = "hand", tremor = 1e-4, path = {
    {position = {0, 0, 0.05}}, {position = {0, 0, 0.02}, speed = p.speed}, {position = {0.05, 0, 0.02}, speed = p.speed} } }
  addDevice(hand)
  grasp(hand, box)
end
measure("chance", math.random(), "1")
outcome(math.random() < 0.5 and "heads" or "tails")
"""
# Where it does not matter what a run does. The sanitizers' program is ten times slower.
LIGHT = ["--set", "bodies=false"]
LIGHTER = LIGHT if SANITIZED else []


def children(pid):
    """The living processes that this one made."""
    with open(f"/proc/{pid}/task/{pid}/children") as f:
        return [int(child) for child in f.read().split()]


class Batches(ProgramTest):
    def setUp(self):
        super().setUp()
        self.scenario = self.write("many.lua", MANY)

    def batch(self, folder, *args, **options):
        return self.run_program("batch", self.scenario, "-o", self.path(folder), *args, **options)

    def batch_json(self, folder, *args, code=0):
        done = self.batch(folder, *args, "--json")
        self.assertEqual(done.returncode, code, done.stderr)
        return json.loads(done.stdout)

    def rows(self, folder, name="index.csv"):
        with open(os.path.join(self.path(folder), name), newline="") as f:
            return list(csv.DictReader(f))

    def index(self, folder):
        with open(os.path.join(self.path(folder), "index.csv"), "rb") as f:
            return f.read()

    def start(self, folder, *args):
        return subprocess.Popen([VERISIM, "batch", self.scenario, "-o", self.path(folder), *args], cwd=self.folder,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    @contextlib.contextmanager
    def database(self, path):
        db = sqlite3.connect(f"file:{path}?mode=rw", uri=True)  # makes none
        try:
            with db:
                yield db
        finally:
            db.close()

    def wait_for(self, what, seconds=60):
        begin = time.monotonic()
        while time.monotonic() - begin < seconds:
            if what():
                return
            time.sleep(0.02)
        self.fail("it never came")

    def done(self, folder, status="done"):
        try:
            with self.database(os.path.join(self.path(folder), "index.sqlite")) as db:
                return db.execute("SELECT count(*) FROM run WHERE status = ?", [status]).fetchone()[0]
        except sqlite3.Error:
            return 0

    def killed(self, folder):
        return self.done(folder, "failed")
