"""Precise contacts of surfaces that fit each other closely: they rest, keep the speed of what slides, and let in what fits.

Judged from recorded poses and forces. VERISIM_LONG_TESTS=1: more clearances, sizes of voxels and sections.
"""
import itertools
import math
import random
import unittest

import numpy as np

import ruler
from scene_test import LONG, SceneTest

DENSITY = 2000
BALL, PIN = 4 / 3 * math.pi * 0.01**3, math.pi * 0.01**2 * 0.04  # m^3
PLUG = math.pi / 3 * 0.025 * (0.0075**2 + 0.0075 * 0.0125 + 0.0125**2)
RING = 2 * math.pi**2 * 0.02 * 0.006**2
VOLUME = {"tube": BALL, "socket": BALL, "cone": BALL, "bowl": BALL, "bore": PIN, "plug": PLUG, "ring": RING}


class ConformingTest(SceneTest):
    def check_rest(self, kind, clearance):
        # Let go where it can rest, but for a small part of the clearance: nothing brakes a ball that swings by 0.01 of it,
        # and it pushes sideways with up to 0.01 of its weight.
        near = max(clearance, 1e-6)
        pose, _, force = self.run_scene("conforming.lua", "body", kind=kind, clearance=clearance, drop=0.05 * near,
                                        side=0.01 * near)
        weight = DENSITY * VOLUME[kind] * 9.81
        late = force[500:]
        self.assertLessEqual(abs(late[:, 2].mean() - weight), 1e-3 * weight)
        sideways = np.sqrt((late[:, :2] ** 2).sum(axis=1).mean())
        self.assertLessEqual(sideways, 0.01 * weight)
        deep = max(0.01 * clearance, 1e-7)
        self.assertLessEqual(self.overlap(kind, clearance, pose[500:]).max(), deep)

    @staticmethod
    def overlap(kind, clearance, pose):
        """How far the body is in its seat, from its place alone (it turns, if at all, about its own axes)."""
        y, z = pose[:, 1], pose[:, 2]
        if kind in ("tube", "bore"):
            return np.hypot(y, z) - clearance
        if kind == "bowl":
            return np.linalg.norm(pose[:, :3], axis=1) - 0.02
        if kind == "ring":  # at most: a ring that is tilted comes nearer by its own radius times the angle
            return np.linalg.norm(pose[:, :3], axis=1) + 0.02 * 2 * np.hypot(pose[:, 3], pose[:, 4]) - clearance
        if kind == "socket":
            return np.linalg.norm(pose[:, :3], axis=1) - clearance
        if kind == "cone":  # to the side of a cone of half angle atan(1 / 2), its tip at z = -0.024
            rho = np.hypot(pose[:, 0], y)
            return 0.01 - ((z + 0.024) / math.sqrt(5) - rho * 2 / math.sqrt(5))
        return np.hypot(pose[:, 0], y) * 0.98 - z * 0.2  # a plug of slope 1 / 5: to first order

    def test_a_hand_holds_it_still_to_the_side_and_askew(self):
        # Its rims run round what is hardly smaller: one place of each went round by 0.1 rad a step and made 36 mN rms.
        # A ball in its socket and a ring in its groove without clearance: where the closest place was beyond the mouth, the
        # places inside it gave no row, and the whole force came every other step. A ball in a socket of 0.05 mm went to and
        # fro between the planes of its rows (2.6 mN). A ring had its rows beside the place that was closest at the end of the
        # step without contact, and none where it touched (11 of 100 draws, 19 mN; askew and without clearance 0.4 N). Of 200
        # rings 3 are above 1 mN still, by 2.6 at most.
        for kind in ("post", "through", "cap", "socket", "ring"):
            for seed in range(24 if LONG else 6):
                draw = random.Random("{} {}".format(kind, seed))
                how = {"c": draw.choice((0, 1e-6, 1e-5, 5e-5)), "press": draw.uniform(0.002, 0.012), "side": draw.uniform(0, 0.01),
                       "tilt": draw.uniform(0, 0.1), "turn": draw.uniform(0, 6.28),
                       "timestep": draw.choice([0.0005, 0.001, 0.002])}
                if kind == "through":
                    how["press"] = 0  # nothing stops it
                with self.subTest(kind=kind, seed=seed, **how):
                    _, _, force = self.run_scene("held_fit.lua", "body", kind=kind, **how)
                    late = force[-int(0.5 / how["timestep"]):]
                    self.assertGreater(np.linalg.norm(late.mean(axis=0)), 0.01)
                    jitter = np.sqrt(((late - late.mean(axis=0)) ** 2).sum(axis=1).mean())
                    self.assertLessEqual(jitter, 1e-3)

    def test_what_fits_closely_rests(self):
        clearances = (0, 1e-6, 1e-5, 3e-5) if LONG else (0, 1e-5)
        for kind in ("tube", "socket", "bore", "ring"):
            for clearance in clearances:
                with self.subTest(kind=kind, clearance=clearance):
                    self.check_rest(kind, clearance)
        for kind in ("cone", "plug", "bowl"):
            with self.subTest(kind=kind):
                self.check_rest(kind, 0)

    def test_a_ball_that_a_hand_presses_into_its_seat_does_not_buzz(self):
        cases = [("flat", 0), ("cone", 0)] + list(itertools.product(("tube", "socket"), (0, 1e-6, 1e-5, 3e-5, 1e-4)))
        for wall, clearance in cases:
            with self.subTest(wall=wall, clearance=clearance):
                pose, _, force = self.run_scene("press.lua", "tool", wall=wall, clearance=clearance, hybrid="exact",
                                                integrator="implicit")
                late = force[-1000:]
                # 300 N/m of the coupling and 400 N/m of the hand in series over 10 mm.
                self.assertAlmostEqual(late[:, 2].mean(), 12 / 7, delta=1e-5)
                jitter = np.sqrt(((late - late.mean(axis=0)) ** 2).sum(axis=1).mean())
                self.assertLessEqual(jitter, 1e-3)
                x, y, z = pose[-1000:, :3].T
                depth = {"flat": 0.015 - z, "cone": 0.015 - (0.6 * (z + 0.08 / 3) - 0.8 * np.hypot(x, y)),
                         "tube": np.hypot(y, z) - clearance, "socket": np.sqrt(x**2 + y**2 + z**2) - clearance}[wall]
                self.assertLessEqual(depth.max(), max(0.01 * clearance, 1e-7))

    def test_a_puck_that_slides_round_a_hole_keeps_its_speed_and_does_not_spin(self):
        for voxelsize in (0.004, 0.002, 0.001) if LONG else (0.004, 0.001):
            with self.subTest(voxelsize=voxelsize):
                pose, twist, _ = self.run_scene("resting_kinds.lua", "b", kind="puck", hybrid="exact", integrator="implicit",
                                                R=0.1, r=0.02, h0=0, start=1, g=0, duration=5, voxelsize=voxelsize)
                self.assertLessEqual(np.abs(np.linalg.norm(twist[:, :3], axis=1) - 1).max(), 1e-3)
                self.assertLessEqual(np.abs(twist[:, 3:]).max(), 0.1)
                # A step along the wall ends (v dt)^2 / 2 (R - r) deep.
                self.assertLessEqual((np.hypot(pose[:, 0], pose[:, 1]) - 0.08).max(), 1.01 * 1e-6 / 0.16)

    def test_what_slides_round_keeps_its_speed_whichever_is_higher(self):
        for kind, inner, outer, step in (("puck", 0.06, 0.06, 1e-3), ("puck", 0.1, 0.06, 1e-3), ("puck", 0.1, 0.06, 5e-4),
                                         ("puck", 0.05, 0.06, 2e-3), ("ring", 0.1, 0.04, 1e-3), ("ring", 0.04, 0.1, 1e-3),
                                         ("ring", 0.04, 0.04, 1e-3), ("torus", 0.1, 0, 1e-3)):
            with self.subTest(kind=kind, inner=inner, outer=outer, step=step):
                _, twist, _ = self.run_scene("round.lua", "b", kind=kind, inner=inner, outer=max(outer, 0.01), timestep=step)
                self.assertLessEqual(np.abs(np.linalg.norm(twist[:, :3], axis=1) - 1).max(), 1e-3)

    def test_what_swings_round_keeps_its_amplitude(self):
        for kind, inner, outer in (("puck", 0.12, 0.1), ("puck", 0.06, 0.1), ("ring", 0.1, 0.03), ("ring", 0.03, 0.1),
                                   ("torus", 0.1, 0)):
            with self.subTest(kind=kind, inner=inner, outer=outer):
                pose, _, _ = self.run_scene("round.lua", "b", kind=kind, inner=inner, outer=max(outer, 0.01), swings="true",
                                            duration=4)
                angle = np.arctan2(pose[:, 0], -pose[:, 1])
                self.assertAlmostEqual(np.abs(angle[-1000:]).max(), 0.3, delta=2e-4)

    def test_half_a_ball_that_swings_in_a_bowl_keeps_its_energy(self):
        """It slides and turns about all its axes without friction. Draws of sizes, bowls, tilts and steps; by central
        differences of poses, the mean of each tenth of 100 sqrt(a / g) against that of the second."""
        for seed in range(24 if LONG else 6):
            draw = np.random.default_rng(seed)
            a, steps = 10 ** draw.uniform(-2.5, -1), int(draw.choice([30, 60, 120]))
            with self.subTest(seed=seed, a=a, steps=steps):
                pose, _, force = self.run_scene(
                    "half_ball.lua", "b", a=a, steps=steps, wide=draw.uniform(1.15, 2), tilt=draw.uniform(0.1, 1.2),
                    turn=draw.uniform(0, 2 * math.pi), aside=draw.uniform(0, 0.6), voxelsize=a / 10,
                    duration=100 * math.sqrt(a / 9.81))
                self.assertGreater(force[len(force) // 10:, 2].min(), 0, "it stays on the bowl")
                energy = ruler.half_ball_energy(pose, a, math.sqrt(a / 9.81) / steps)
                of_tenths = [part.mean() for part in np.array_split(energy, 10)[1:]]
                self.assertLess(max(of_tenths), (1 + 5e-4) * of_tenths[0])
                self.assertGreater(min(of_tenths), (1 - 2e-3) * of_tenths[0])

    def test_sections_with_bands_enter_their_holes_without_blows(self):
        kinds = ("oct", "hex", "square", "tri") if LONG else ("oct", "square", "tri")
        for c in (5e-6, 2e-5, 1e-4) if LONG else (2e-5,):
            of_pin = self.largest_force(self.run_scene("entry.lua", "peg", kind="round", c=c))
            for kind in kinds:
                with self.subTest(kind=kind, c=c):
                    recorded = self.run_scene("entry.lua", "peg", kind=kind, c=c)
                    self.assertLess(recorded.pose[-1, 2], 0.012, "it goes in")
                    self.assertLessEqual(self.largest_force(recorded), 2 * of_pin)
                    self.assertLessEqual(self.true_overlap(), 1e-6)


if __name__ == "__main__":
    unittest.main()
