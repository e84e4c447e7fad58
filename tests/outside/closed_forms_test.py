"""Precise contacts beside closed forms: weight, a slope, a ball in a bowl, a pin that wedges. From recorded poses and forces."""
import math
import unittest

import numpy as np

from scene_test import LONG, SceneTest

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


    def test_an_insertion_converges_with_the_step(self):
        """Of first order, in the long form down to steps of 12.5 us: where the pin ends and what pushes on it there."""
        for sides, clearance in ((0, 1e-4), (8, 2e-5)):
            with self.subTest(sides=sides, clearance=clearance):
                places, forces = [], []
                steps = 4e-4 * 0.5**np.arange(6 if LONG else 3)
                for step in steps:
                    peg = self.run_scene("prism_entry.lua", "peg", n=sides, c=clearance, tremor=0, timestep=step)
                    last = round(0.5 / step)
                    places.append(peg.pose[-last, 2])
                    forces.append(np.linalg.norm(peg.force[-last:], axis=1).mean())
                self.assertLess((np.abs(np.diff(places)) / steps[:-1]).max(), 0.02)  # m/s
                self.assertLess(np.ptp(forces), 1e-3 * forces[0])

    @staticmethod
    def wedged_at(R, r, height):
        """The tilt at which a pin touches its hole on both sides, `height` apart: 2 R cos(t) - height sin(t) = 2 r."""
        low, high = 0.0, 0.5
        for _ in range(100):
            t = (low + high) / 2
            low, high = (t, high) if 2 * R * math.cos(t) - height * math.sin(t) > 2 * r else (low, t)
        return (low + high) / 2

    def test_a_pin_wedges_at_the_tilt_that_its_clearance_allows(self):
        R, half_length, upper_rim = 0.075, 0.2, 0.1
        through = [(c, 0.3) for c in (5e-3, 5e-4, 5e-5, 1e-5)]  # ORACLES gives these: 2.81410 degrees ...
        partly = [(5e-3, 0.15), (5e-4, 0.12), (5e-4, 0.05), (5e-5, 0.05), (1e-5, 0.12)]
        for clearance, entered in through + partly:
            with self.subTest(clearance=clearance, entered=entered):
                r = R - clearance
                # A hand that holds only the direction lets a pin that is not all through move aside, to the wall.
                pose, _, force = self.run_scene("wedge.lua", "pin", clearance=clearance, entered=entered,
                                                turn=self.wedged_at(R, r, min(entered, 0.2)),
                                                stiffness=3000 if entered > 0.2 else 10)
                _, _, z, qx, qy, qz, qw = pose[-1]
                tilt = math.atan2(2 * math.hypot(qx * qz + qy * qw, qy * qz - qx * qw), 1 - 2 * (qx * qx + qy * qy))
                height = 0.2
                if entered < 0.2:  # from the hole's rim down to the pin's lower edge, where that now is
                    height = upper_rim - (z + r * math.sin(tilt) - half_length * math.cos(tilt))
                    self.assertGreater(height, 0.01, "it has not left the hole")
                self.assertGreater(np.linalg.norm(force[-1]), 0)
                self.assertAlmostEqual(tilt / self.wedged_at(R, r, height), 1, delta=1e-5)


if __name__ == "__main__":
    unittest.main()
