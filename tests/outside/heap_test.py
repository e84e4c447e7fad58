"""Boxes that fall into a tray and lie on each other while others fall on them.

Judged from recorded poses. VERISIM_LONG_TESTS=1: more draws.
"""
import collections
import os
import unittest

import h5py
import numpy as np

import ruler
from scene_test import HERE, LONG, SceneTest

SCENARIOS = os.path.join(HERE, os.pardir, os.pardir, "scenarios")
SIDE, BOXES = 0.03, 100
DEEP = 5e-5  # m
LAY = 1e-5  # m: what was no deeper lay on the other, or was apart from it


class HeapTest(SceneTest):
    def recorded_depths(self):
        """What the run file says of each two boxes, by frame [m]."""
        depths = collections.defaultdict(dict)
        with h5py.File(self.run_file) as f:
            links = f["state/links"]
            number = [[int(name[3:]) - 1 if name.startswith(b"box") else None for name in pair] for pair in f["state/pairs"][:]]
            for frame, pair, depth in zip(links["frame"][:], links["pair"][:], links["max_penetration"][:]):
                if depth > 0 and None not in number[pair]:
                    depths[frame][tuple(sorted(number[pair]))] = depth
        return depths

    def judge(self, seed):
        """No box that lay on another one, or came to it, is far inside of it after one step; and the record is right."""
        boxes = self.run_scene("tray.lua", *(f"box{i + 1}" for i in range(BOXES)), folder=SCENARIOS, seed=seed,
                               seconds=0.6, boxes=BOXES)
        recorded = self.recorded_depths()
        before = {}
        for frame, poses in enumerate(np.stack([box.pose for box in boxes], axis=1), 1):  # the poses at its start
            now = ruler.box_separations(poses, SIDE)
            for pair, apart in now.items():
                said, depth = recorded[frame].get(pair, 0), max(0, -apart)
                if before.get(pair, 1) > -LAY:
                    self.assertLess(depth, DEEP, (frame, pair))
                if frame < len(boxes[0].pose):  # of two edges the record has the distance to the nearer face
                    self.assertLess(said, 1.1 * depth + 5e-6, (frame, pair, depth))
                    self.assertGreater(said, 0.9 * np.sqrt(0.5) * depth - 5e-6, (frame, pair, depth))
            before = now

    def test_no_box_is_suddenly_inside_of_another_and_the_record_says_how_deep_they_are(self):
        """Neither what lies, where a blow from elsewhere turns it about its other edge, nor what stands upright on the
        same floor and slides up to it."""
        for seed in range(1, 25 if LONG else 5):
            with self.subTest(seed=seed):
                self.judge(seed)


if __name__ == "__main__":
    unittest.main()
