"""Precise contacts beside closed forms: weight, a slope, a ball in a bowl. From recorded poses and forces."""
import math
import unittest

import numpy as np

from scene_test import SceneTest

G = 9.81  # m/s^2
EXACT = {"hybrid": "exact", "integrator": "implicit"}


class ClosedForms(SceneTest):
    def test_what_rests_pushes_with_its_weight(self):
        volume = {"box": 0.06 * 0.04 * 0.04, "sphere": 4 / 3 * math.pi * 0.02**3, "cylside": math.pi * 0.02**2 * 0.08}
        for kind, v in volume.items():
            with self.subTest(kind=kind):
                force = self.run_scene("resting.lua", "b", kind=kind, **EXACT).force
                weight = 1000 * v * G
                self.assertLessEqual(np.abs(force[1000:, 2] - weight).max(), 1e-6 * weight)

    def test_what_slides_down_a_slope_gains_g_sin_theta(self):
        for angle in (2, 10, 30):
            with self.subTest(angle=angle):
                twist = self.run_scene("resting_kinds.lua", "b", kind="incline", angle=angle, g=G, h0=0, duration=0.3,
                                       **EXACT).twist
                speed = np.linalg.norm(twist[:, :3], axis=1)
                gained = np.polyfit(np.arange(len(speed))[100:] * 1e-3, speed[100:], 1)[0]
                self.assertAlmostEqual(gained / (G * math.sin(math.radians(angle))), 1, delta=1e-3)

    def test_a_ball_swings_in_a_bowl_as_a_pendulum_does(self):
        for amplitude in (0.1, 0.3, 0.6):
            with self.subTest(amplitude=amplitude):
                x = self.run_scene("resting_kinds.lua", "b", kind="bowl", R=0.1, r=0.02, start=amplitude, g=G, h0=0,
                                   duration=4, **EXACT).pose[:, 0]
                i = np.flatnonzero(x[:-1] * x[1:] < 0)
                crossings = (i + x[i] / (x[i] - x[i + 1])) * 1e-3
                a, b = 1.0, math.cos(amplitude / 2)  # 4 K(sin(amplitude / 2)) = 2 pi / their mean
                for _ in range(6):
                    a, b = (a + b) / 2, math.sqrt(a * b)
                period = 2 * math.pi / a * math.sqrt(0.08 / G)
                self.assertAlmostEqual(2 * np.diff(crossings).mean() / period, 1, delta=1e-4)


if __name__ == "__main__":
    unittest.main()
