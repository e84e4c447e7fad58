"""Scenes of the hybrid method under `exact`: round things in their seats, plates with pins. VERISIM_SEEDS: how many trials
of each."""
import os
import unittest

import h5py
import numpy

from program import ProgramTest, SOURCE

SEEDS = range(1, 1 + int(os.environ.get("VERISIM_SEEDS", "3")))


class PreciseScenes(ProgramTest):
    def outcome(self, scene, seed=1, jump=None, **settings):
        """With `jump`, no contact force changes by more than so much [N] from one frame to the next."""
        run_file = self.path("run.h5")
        options = [word for key, value in {"hybrid": "exact", **settings}.items() for word in ("--set", f"{key}={value}")]
        summary = self.run_json("run", os.path.join(SOURCE, "scenarios", scene + ".lua"), "-o", run_file, "--seed", seed,
                                *options)
        if jump is not None:
            with h5py.File(run_file) as f:
                link, = f["state/link"]
                force = f[f"state/link/{link}/wrench"][:, :3]
            self.assertLessEqual(numpy.linalg.norm(numpy.diff(force, axis=0), axis=1).max(), jump, f"{settings} {seed}")
        return summary["outcome"]

    def test_round_things_reach_their_seats(self):
        for kind in ("cone", "ball", "socket"):
            for clearance in (1, 0.01):
                with self.subTest(kind=kind, clearance=clearance):
                    self.assertEqual(self.outcome("seats", kind=kind, clearance=f"mm({clearance})", jump=5), "seated")

    # The plate weighs 25 g: two of its pins that snap into their holes at 1 m/s are stopped with 25 N.
    def test_pins_that_fit_go_in_without_a_jump(self):
        for seed in SEEDS:
            self.assertEqual(self.outcome("pins", seed, kind="fitting", jump=40), "assembled", seed)
            self.outcome("pins", seed, kind="fitting", clearance="mm(0.2)", jump=40)

    def test_one_pin_of_two_goes_in_alone(self):
        for seed in SEEDS:
            self.assertEqual(self.outcome("pins", seed, kind="single", jump=40), "assembled", seed)

    def test_pins_that_lean_or_are_too_far_apart_never_go_in(self):
        for seed in SEEDS:
            for kind in ("angled", "spaced"):
                self.assertEqual(self.outcome("pins", seed, kind=kind, jump=40), "not assembled", (kind, seed))


if __name__ == "__main__":
    unittest.main()
