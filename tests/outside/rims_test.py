"""What comes over a rim, below which there is another face, is not deep below that face."""
import unittest

import h5py
import numpy as np

from scene_test import LONG, SceneTest


class RimsTest(SceneTest):
    def test_a_cut_torus_that_slides_over_a_rim_is_not_recorded_as_deep_below_it(self):
        """It was, by the height of its centre above the base, wherever the part that is nearest to the rim is cut away."""
        draw = np.random.default_rng(3)
        for i in range(60 if LONG else 15):
            settings = {"timestep": (5e-4, 1e-3, 2e-3)[i % 3], "turn": draw.uniform(0, 6.28),
                        "outward": draw.uniform(0.1, 0.5), "across": draw.uniform(-0.1, 0.1), "spin": draw.uniform(-5, 5)}
            with self.subTest(**settings):
                ring = self.run_scene("cut_torus_over_rim.lua", "ring", **settings)
                self.assertGreater(np.hypot(ring.pose[:, 0], ring.pose[:, 1]).max(), 0.056, "it has come to the rim")
                with h5py.File(self.run_file) as f:
                    self.assertLess(f["state/links/max_penetration"][:].max(), 5e-5)


if __name__ == "__main__":
    unittest.main()
