"""What the tests of this folder share: a scene is run by the program, and judged by what it recorded."""
import collections
import json
import os
import shutil
import subprocess
import tempfile
import unittest

import h5py
import numpy as np

VERISIM = os.environ["VERISIM"]
HERE = os.path.dirname(os.path.abspath(__file__))
LONG = os.environ.get("VERISIM_LONG_TESTS") == "1"

# Of one body, a row per frame: x y z qx qy qz qw; vx vy vz wx wy wz; the contact force.
Recorded = collections.namedtuple("Recorded", "pose twist force")


class SceneTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)
        self.run_file = os.path.join(self.folder, "run.h5")

    def run_scene(self, scene, *bodies, folder=HERE, seconds=None, seed=None, **settings):
        """What is recorded of a body; a list of several."""
        command = [VERISIM, "run", os.path.join(folder, scene), "--quiet", "--force", "-o", self.run_file]
        command += ["--duration", str(seconds)] if seconds else []
        command += ["--seed", str(seed)] if seed is not None else []
        for name, value in settings.items():
            command += ["--set", "{}={}".format(name, value if isinstance(value, str) else repr(float(value)))]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        with h5py.File(self.run_file) as f:
            of = [f["state/body/" + body] for body in bodies]
            recorded = [Recorded(o["pose"][:], o["twist"][:], o["force"][:, :3]) for o in of]
        return recorded[0] if len(bodies) == 1 else recorded

    @staticmethod
    def largest_force(recorded):
        return np.linalg.norm(recorded.force, axis=1).max()

    def true_overlap(self, by=None):
        """The largest of the last run, by `replay --measure` [m]; of meshes by their faces' "surfaces"."""
        done = subprocess.run([VERISIM, "replay", self.run_file, "--measure", "--json"], capture_output=True, text=True,
                              check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        pairs = json.loads(done.stdout)["measured"]["pairs"]
        return max(max((pair[by] if by else pair)["overlap_m"]) for pair in pairs)
