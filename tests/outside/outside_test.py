"""Scenes in which contact was found wrong, judged by geometry from recorded poses alone (ruler.py).

VERISIM_LONG_TESTS=1: 24 drops at four sizes of voxels instead of six at one; prisms of 3 to 12 sides.
"""
import math
import os
import shutil
import subprocess
import tempfile
import unittest

import h5py
import numpy as np

import ruler

VERISIM = os.environ["VERISIM"]
HERE = os.path.dirname(os.path.abspath(__file__))
LONG = os.environ.get("VERISIM_LONG_TESTS") == "1"
CYLINDER_MASS = 2000 * math.pi * 0.01**2 * 0.03  # kg


class OutsideTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)

    def run_scene(self, scene, body, **settings):
        """Poses and velocities of a body, and the run's links."""
        out = os.path.join(self.folder, "run.h5")
        command = [VERISIM, "run", os.path.join(HERE, scene), "--quiet", "-o", out]
        for name, value in settings.items():
            command += ["--set", "{}={}".format(name, value if isinstance(value, str) else repr(float(value)))]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        with h5py.File(out) as f:
            links = f["state/links"]
            force = np.linalg.norm(links["wrench"][:, :3], axis=1).max(initial=0)
            return f["state/body/" + body + "/pose"][:], f["state/body/" + body + "/twist"][:], force

    def random_drop(self, seed):
        """A cylinder at rest at any angle, up to 4 mm above the groove, given a push."""
        draw = np.random.default_rng(seed)
        q = draw.normal(size=4)
        pose = np.concatenate([[draw.uniform(-0.025, 0.025), draw.uniform(-0.02, 0.02), 0], q / np.linalg.norm(q)])[None]
        low, high = -0.03, 0.05
        for _ in range(40):
            pose[0, 2] = (low + high) / 2
            if ruler.overlap_of_cylinder_and_groove(pose)[0] < -0.001:
                high = pose[0, 2]
            else:
                low = pose[0, 2]
        pose[0, 2] = high + draw.uniform(0, 0.004)
        values = np.concatenate([pose[0], draw.uniform(-0.1, 0.1, 3), draw.uniform(-3, 3, 3)])
        return dict(zip("x y z qx qy qz qw vx vy vz wx wy wz".split(), values))

    def check_cylinder(self, **settings):
        pose, twist, _ = self.run_scene("cylinder_in_groove.lua", "b", **settings)
        overlap = ruler.overlap_of_cylinder_and_groove(pose).max()
        energy = ruler.cylinder_energy(pose, twist, CYLINDER_MASS)
        gain = (energy - np.minimum.accumulate(energy)).max()
        self.assertLessEqual(overlap, 20e-6)
        # WANTED
        self.assertLessEqual(gain, 2e-3 * (energy[0] - energy.min()))

    def test_the_rim_of_a_lying_cylinder_does_not_sink_into_the_grooves_edge(self):
        self.check_cylinder()

    def test_cylinders_that_fall_into_a_groove_overlap_by_micrometres(self):
        for voxelsize in ((0.0005, 0.001, 0.002, 0.004) if LONG else (0.002,)):
            for seed in (range(24) if LONG else (1, 4, 7, 8, 12, 19)):  # those that were lost
                with self.subTest(seed=seed, voxelsize=voxelsize):
                    self.check_cylinder(voxelsize=voxelsize, duration=0.6, **self.random_drop(seed))

    def test_prisms_fit_into_their_holes(self):
        clearances = (5e-6, 2e-5, 1e-4) if LONG else (2e-5,)
        for c in clearances:
            _, _, of_pin = self.run_scene("prism_entry.lua", "peg", n=0, c=c)
            for n in (range(3, 13) if LONG else (4, 8)):
                with self.subTest(n=n, c=c):
                    pose, _, force = self.run_scene("prism_entry.lua", "peg", n=n, c=c)
                    overlap = ruler.overlap_of_prism_and_hole(pose, n, c)
                    inside = pose[:, 2] < 0.043  # the lead-in and 1 mm more are within the block
                    self.assertTrue(inside[-1], "it goes in")
                    # Wanted: 0.02 c. Two of 30 differ at 5 um, where it is a rounding of contacts (1e-7 m).
                    self.assertLessEqual(overlap[inside].max(), max(0.02 * c, 1.4e-7))
                    self.assertLessEqual(overlap.max(), 1e-6)
                    self.assertLessEqual(force, 2 * of_pin)


if __name__ == "__main__":
    unittest.main()
