"""What holds each other closely all round, moved by a hand or flying freely. Judged by `replay --measure` and from poses.
VERISIM_LONG_TESTS=1: 20 draws of every kind instead of the first 0.4 s of one."""
import random
import unittest

import h5py
import numpy as np

from scene_test import LONG, SceneTest

KINDS = ("dovetail", "tslot", "key", "hexagon", "collars", "balljoint", "chain") + (("hinge", "bayonet") if LONG else ())
DRAWS, SECONDS = (20, None) if LONG else (1, 0.4)
# An edge of the one in a corner of the other, beyond the ends of both edges there by a rounding, was taken for a place
# as deep as the face beside is wide: 0.17 to 0.96 mm, and the bodies were moved by as much.
WRONG_ONCE = (
    {"kind": "hexagon", "c": 5e-6, "yaw": 0, "pitch": 0, "speed": 0.3, "side": 0.0007362223772925809,
     "tilt": 0.0934101682768518, "timestep": 0.001, "voxelsize": 0.002, "draw": 976},
    {"kind": "tslot", "c": 1e-4, "yaw": 2.5316032528947026, "pitch": 0.9829895219328927, "speed": 0.3,
     "side": 0.001728045412433065, "tilt": 0.004015735628304995, "timestep": 0.002, "voxelsize": 0.002, "draw": 182},
)
DEEP, ALIKE = 5e-5, 5e-6  # m


class JointsTest(SceneTest):
    def settings(self, kind, draw):
        chosen = random.Random("{} {}".format(kind, draw))
        either = lambda most: chosen.choice([0, chosen.uniform(0, most)])
        return {"kind": kind, "c": chosen.choice([5e-6, 2e-5, 1e-4]), "yaw": either(3), "pitch": either(3),
                "timestep": chosen.choice([5e-4, 1e-3, 2e-3]), "voxelsize": chosen.choice([1e-3, 2e-3]),
                "speed": chosen.choice([0.1, 0.3, 0.6]), "side": chosen.uniform(0, 2e-3), "tilt": chosen.uniform(0, 0.1),
                "v": chosen.uniform(0.05, 0.5), "w": chosen.uniform(0, 10), "draw": chosen.randint(1, 1000)}

    def judge(self, seconds=SECONDS, **settings):
        """The record is true, and nothing is deep. @returns the energy of motion of each frame"""
        self.run_scene("joints.lua", "body", seconds=seconds, **settings)
        with h5py.File(self.run_file) as f:
            recorded = f["state/links/max_penetration"][:].max()
            self.assertNotIn(b"overlap", f["events"]["kind"])
            kinetic = f["state/energy"][:, 0]
        true = self.true_overlap()
        self.assertLess(true, DEEP)
        self.assertLess(recorded - true, ALIKE)
        self.assertLess(true - recorded, ALIKE)
        return kinetic

    def test_a_hand_moves_one_of_them(self):
        for settings in [self.settings(kind, i) for kind in KINDS for i in range(DRAWS)]:
            with self.subTest(**settings):
                self.judge(mode="hand", **settings)

    def test_what_was_wrong_once(self):
        for settings in WRONG_ONCE:
            with self.subTest(**settings):
                self.judge(seconds=0.7, mode="hand", **settings)

    def test_they_rattle_and_gain_no_energy(self):
        kinds = KINDS if LONG else ("tslot", "collars", "balljoint")
        for settings in [self.settings(kind, i) for kind in kinds for i in range(DRAWS)]:
            with self.subTest(**settings):
                kinetic = self.judge(mode="free", **settings)
                least = np.minimum.accumulate(kinetic)
                self.assertLess((kinetic - least).max(), 1e-3 * kinetic[0])


if __name__ == "__main__":
    unittest.main()
