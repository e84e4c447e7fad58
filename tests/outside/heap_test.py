"""Boxes that fall into a tray and lie on each other while others fall on them.

Judged from recorded poses. VERISIM_LONG_TESTS=1: more draws.
"""
import os
import unittest

import numpy as np

import ruler
from scene_test import HERE, LONG, SceneTest

SCENARIOS = os.path.join(HERE, os.pardir, os.pardir, "scenarios")
SIDE, BOXES = 0.03, 100
LAY = 1e-5  # m: what was no deeper lay on the other, or was apart from it


class HeapTest(SceneTest):
    def pressed_in(self, seed):
        """The farthest that a box which lay on another one, or came to it, is inside of it after one step [m]."""
        boxes = self.run_scene("tray.lua", *(f"box{i + 1}" for i in range(BOXES)), folder=SCENARIOS, seed=seed,
                               seconds=0.6, boxes=BOXES)
        before, most = {}, 0
        for poses in np.stack([box.pose for box in boxes], axis=1):
            now = ruler.box_separations(poses, SIDE)
            most = max([most] + [-s for pair, s in now.items() if before.get(pair, 1) > -LAY])
            before = now
        return most

    def test_no_box_is_suddenly_inside_of_another(self):
        """By 50 um: neither what lies, where a blow from elsewhere turns it about its other edge, nor what stands upright
        on the same floor and slides up to it."""
        for seed in range(1, 25 if LONG else 5):
            with self.subTest(seed=seed):
                self.assertLess(self.pressed_in(seed), 5e-5)


if __name__ == "__main__":
    unittest.main()
