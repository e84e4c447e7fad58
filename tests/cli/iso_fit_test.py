"""Fits of ISO 286 in the driven scene: what has clearance goes together in every trial, what has interference in none.
VERISIM_SEEDS=200 is the long form; each trial is one seed of one nominal size, fit and size within the tolerances."""
import functools
import math
import os
import unittest

import h5py
import numpy

from program import ProgramTest, SOURCE, dense

SEEDS = int(os.environ.get("VERISIM_SEEDS", "1"))
NOMINALS = [10, 25, 75, 120]  # mm
SPEED = 0.03    # m/s, the hand's
TREMBLE = 2 * math.pi * 10 * 5e-5  # m/s, of the hand's tremor: 0.05 mm rms about 10 Hz
PUSH = 15       # N, its spring's 400 N/m with a lead of 25 mm, and half as much again of its damper
STEP = 0.001    # s


class IsoFit(ProgramTest):
    def trial(self, seed, nominal, fit, **settings):
        run_file = self.path("run.h5")
        pairs = {"nominal": f"mm({nominal})", "fit": fit, **settings}
        options = [word for key, value in pairs.items() for word in ("--set", f"{key}={value}")]
        summary = self.run_json("run", os.path.join(SOURCE, "scenarios", "iso_fit.lua"), "-o", run_file, "--seed", seed,
                                *options)
        self.assert_forces_are_continuous(run_file, nominal, f"{nominal} mm {fit} {settings} seed {seed}")
        return summary["outcome"] == "inserted"

    def assert_forces_are_continuous(self, run_file, nominal, what):
        """Of two frames the one's force may come from a wall and the other's from that opposite: each holds against
        what the hand presses then, and stops the pin, at the speed that its fastest end came with, the tremor's at
        least. Never is a step more than stops the pin at the hand's speed, and its push."""
        d = nominal * 1e-3
        mass = 7800 * math.pi / 4 * d * d * 2 * d
        with h5py.File(run_file) as f:
            force = dense(f, "block", "pin", "wrench")[:, :3]
            press = f["state/device/hand/wrench"][:, :3]
            twist = f["state/body/pin/twist"][()]
        norm = functools.partial(numpy.linalg.norm, axis=1)
        steps, press = norm(numpy.diff(force, axis=0)), norm(press)
        before = numpy.concatenate([[0], (norm(twist[:, :3]) + d * norm(twist[:, 3:]))[:-1]])  # d: half its length
        stopped = numpy.maximum(before[:-1] + before[1:], 2 * TREMBLE)
        bound = numpy.minimum(mass * stopped / STEP + press[:-1] + press[1:], mass * SPEED / STEP + PUSH)
        worst = (steps - bound).argmax()
        self.assertLessEqual(steps[worst], bound[worst], f"{what}, frame {worst + 1}")

    def trials(self, fits, sizes):
        return [(seed, nominal, fit, size) for nominal in NOMINALS for fit in fits for size in sizes
                for seed in range(1, SEEDS + 1)]

    def test_limits_are_those_of_iso_286(self):
        """Largest and least clearance [um, on the diameter] as tables of fits print them; less than 0: interference."""
        for nominal, fit, largest, least in [(3, "H7/g6", 18, 2), (10, "H7/p6", 0, -24), (18, "H8/f7", 61, 16),
                                             (25, "H7/g6", 41, 7), (50, "H7/h6", 41, 0), (50, "H8/k8", 39, -39),
                                             (65, "H7/r6", -11, -60), (75, "H8/f7", 106, 30), (100, "H7/n6", 12, -45),
                                             (120, "H7/s6", -44, -101), (25, "G7/h6", 41, 7), (25, "F8/h7", 74, 20),
                                             (40, "E9/h8", 151, 50), (80, "D10/h9", 294, 100), (100, "G7/js6", 58, 1),
                                             (25, "H7/js6", 27.5, -6.5), (25, "JS7/h6", 23.5, -10.5)]:
            for size, want in (("loosest", largest), ("tightest", least), ("mid", 0.5 * (largest + least))):
                pairs = {"nominal": f"mm({nominal})", "fit": fit, "size": size, "duration": 0.03}
                options = [word for key, value in pairs.items() for word in ("--set", f"{key}={value}")]
                summary = self.run_json("run", os.path.join(SOURCE, "scenarios", "iso_fit.lua"), "-o",
                                        self.path("run.h5"), *options)
                self.assertAlmostEqual(2e6 * summary["measures"]["clearance"]["value"], want, places=6, msg=str(pairs))

    def test_clearance_goes_together_in_every_trial(self):
        for seed, nominal, fit, size in self.trials(["H7/g6", "H8/f7"], ["loosest", "mid", "tightest"]):
            with self.subTest(nominal=nominal, fit=fit, size=size, seed=seed):
                self.assertTrue(self.trial(seed, nominal, fit, size=size))

    def test_interference_goes_together_in_none(self):
        for seed, nominal, fit, size in self.trials(["H7/p6", "H7/s6"], ["mid", "tightest"]):
            with self.subTest(nominal=nominal, fit=fit, size=size, seed=seed):
                self.assertFalse(self.trial(seed, nominal, fit, size=size))

    def test_a_sharp_rim_is_found_by_the_spiral_in_95_of_100(self):
        trials = self.trials(["H7/g6"], ["mid"])
        found = sum(self.trial(seed, nominal, fit, size=size, chamfer=0) for seed, nominal, fit, size in trials)
        self.assertGreaterEqual(found, 0.95 * len(trials))


if __name__ == "__main__":
    unittest.main()
