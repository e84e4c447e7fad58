"""What fits closely and moves along its fit while it is stopped across it. Judged from recorded poses."""
import unittest

import numpy as np

import ruler
from scene_test import LONG, SceneTest

DEEP, G = 5e-5, 9.81  # m, m/s^2


class FitsTest(SceneTest):
    def test_a_ball_that_flies_along_a_bore_stays_in_it(self):
        draw = np.random.default_rng(1)
        for i in range(120 if LONG else 30):
            settings = {"timestep": (5e-4, 1e-3, 2e-3)[i % 3], "clearance": draw.choice([6e-6, 6e-5]),
                        "v": draw.uniform(0.05, 1), "angle": draw.uniform(0, 6.28), "along": draw.uniform(0, 0.7)}
            with self.subTest(**settings):
                pose = self.run_scene("ball_in_bore.lua", "ball", **settings).pose
                pose = pose[np.abs(pose[:, 2]) < 0.015]
                self.assertLess(np.hypot(pose[:, 0], pose[:, 1]).max() - settings["clearance"], DEEP)

    def test_a_ring_falls_along_its_post_and_gains_no_energy(self):
        draw = np.random.default_rng(2)
        for i in range(120 if LONG else 30):
            settings = {"timestep": (5e-4, 1e-3, 2e-3)[i % 3], "clearance": draw.choice([2.5e-7, 2.5e-6, 1e-5]),
                        "vx": draw.uniform(-0.1, 0.1), "vy": draw.uniform(-0.1, 0.1), "vz": draw.uniform(-0.5, -0.05),
                        "spin": draw.uniform(-3, 3)}
            with self.subTest(**settings):
                ring = self.run_scene("ring_on_post.lua", "ring", **settings)
                self.assertLess(self.overlap_with_post(ring.pose, settings["clearance"]), DEEP)
                energy = self.energy(ring, settings["clearance"])  # of it, what there is to lose: down to the foot
                self.assertLess(energy.max() - energy[0], 0.01 * (energy[0] - G * 0.0015))

    def energy(self, ring, clearance):
        """Kinetic, of a torus that turns, and potential, per mass."""
        middle, tube = 0.004 + clearance, 0.0015
        about_axis, across = middle**2 + 0.75 * tube**2, 0.5 * middle**2 + 0.625 * tube**2
        linear, angular = ring.twist[:, :3], ring.twist[:, 3:]
        along = (ruler.rotations(ring.pose)[:, :, 2] * angular).sum(axis=1)
        turning = across * (angular**2).sum(axis=1) + (about_axis - across) * along**2
        return 0.5 * ((linear**2).sum(axis=1) + turning) + G * ring.pose[:, 2]

    def overlap_with_post(self, poses, clearance):
        """The ring's middle circle is to be the tube's radius and the post's away from the axis."""
        turn = np.linspace(0, 2 * np.pi, 361)
        circle = (0.004 + clearance) * np.stack([np.cos(turn), np.sin(turn), 0 * turn], axis=1)
        middle = np.einsum("fij,pj->fpi", ruler.rotations(poses), circle) + poses[:, None, :3]
        return 0.004 - np.hypot(middle[..., 0], middle[..., 1]).min()


if __name__ == "__main__":
    unittest.main()
