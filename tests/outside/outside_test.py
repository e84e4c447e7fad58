"""Scenes in which contact was found wrong, judged by geometry from recorded poses alone (ruler.py).

VERISIM_LONG_TESTS=1: 24 drops at four sizes of voxels instead of six at one; prisms of 3 to 12 sides.
"""
import math
import unittest

import numpy as np

import ruler
from scene_test import LONG, SceneTest

CYLINDER_MASS = 2000 * math.pi * 0.01**2 * 0.03  # kg


class OutsideTest(SceneTest):
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
        pose = self.run_scene("cylinder_in_groove.lua", "b", **settings).pose
        overlap = ruler.overlap_of_cylinder_and_groove(pose).max()
        energy = ruler.cylinder_energy(pose, CYLINDER_MASS)
        gain = (energy - np.minimum.accumulate(energy)).max()
        self.assertLessEqual(overlap, 20e-6)
        self.assertLessEqual(gain, 1e-3 * (energy[0] - energy.min()))

    def test_the_rim_of_a_lying_cylinder_does_not_sink_into_the_grooves_edge(self):
        self.check_cylinder()

    def test_cylinders_that_fall_into_a_groove_overlap_by_micrometres(self):
        # Those that were lost. A step of 3 was to end on a place of the plate that the groove has cut away: its rim was
        # pushed where it touched nothing, and gained 0.5 % of energy.
        wrong_once = ((1, 0.002), (4, 0.002), (7, 0.002), (8, 0.002), (12, 0.002), (19, 0.002), (3, 0.001))
        every = [(seed, voxelsize) for voxelsize in (0.0005, 0.001, 0.002, 0.004) for seed in range(24)]
        for seed, voxelsize in every if LONG else wrong_once:
            with self.subTest(seed=seed, voxelsize=voxelsize):
                self.check_cylinder(voxelsize=voxelsize, duration=0.6, **self.random_drop(seed))

    def test_prisms_fit_into_their_holes(self):
        clearances = (5e-6, 2e-5, 1e-4) if LONG else (2e-5,)
        for c in clearances:
            of_pin = self.largest_force(self.run_scene("prism_entry.lua", "peg", n=0, c=c))
            for n in (range(3, 13) if LONG else (3, 4, 8)):
                with self.subTest(n=n, c=c):
                    recorded = self.run_scene("prism_entry.lua", "peg", n=n, c=c)
                    overlap = ruler.overlap_of_prism_and_hole(recorded.pose, n, c)
                    inside = recorded.pose[:, 2] < 0.043  # the lead-in and 1 mm more are within the block
                    self.assertTrue(inside[-1], "it goes in")
                    self.assertLessEqual(overlap[inside].max(), 0.02 * c)
                    self.assertLessEqual(overlap.max(), 1e-6)
                    self.assertLessEqual(self.largest_force(recorded), 2 * of_pin)

    @staticmethod
    def misjudged(seed):
        """A prism, its clearance, and how a hand misjudges the hole."""
        draw = np.random.default_rng(seed)
        return {"n": 3 + seed % 6, "c": np.exp(draw.uniform(np.log(5e-6), np.log(1e-4))), "dir": draw.uniform(0, 360),
                "error": draw.uniform(3e-4, 6e-4), "tilt": np.deg2rad(draw.uniform(0.2, 0.8)),
                "speed": draw.uniform(0.03, 0.08), "timestep": draw.choice([5e-4, 1e-3]),
                "voxelsize": draw.uniform(1e-3, 4e-3)}

    def test_prisms_enter_however_a_hand_misjudges_their_holes(self):
        # 0 and 60 came down on a corner of the hole with the edge between two lead-in planes, and sank by 5.8 and 1.8 um:
        # the corner was an end of an edge that no face held. 1 and 3 slid down a corner with an edge of theirs, and each
        # of the hole's two edges there ended a nanometre short of it in turn; so did 84, where the corner is sharp
        # (8.8 um). 49 turned across an edge within a step; 24 did with a corner on the hole's wall.
        for seed in range(90) if LONG else (0, 1, 2, 3, 10, 24, 49, 60, 84):
            settings = self.misjudged(seed)
            with self.subTest(seed=seed, **settings):
                recorded = self.run_scene("prism_entry.lua", "peg", seed=seed, **settings)
                overlap = ruler.overlap_of_prism_and_hole(recorded.pose, settings["n"], settings["c"])
                inside = recorded.pose[:, 2] < 0.043
                self.assertTrue(inside[-1], "it goes in")
                self.assertLessEqual(overlap.max(), 1e-6)
                self.assertLessEqual(overlap[inside].max(), 0.02 * settings["c"])


if __name__ == "__main__":
    unittest.main()
