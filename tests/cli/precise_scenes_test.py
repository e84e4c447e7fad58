"""Scenes of the hybrid method under `exact`: round things in their seats, plates with pins. VERISIM_SEEDS: how many trials
of each."""
import os
import unittest

import h5py
import numpy

from program import ProgramTest, SOURCE, dense

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
                pair, = f["state/pairs"]
                force = dense(f, pair["first"].decode(), pair["second"].decode(), "wrench")[:, :3]
            self.assertLessEqual(numpy.linalg.norm(numpy.diff(force, axis=0), axis=1).max(), jump, f"{settings} {seed}")
        return summary["outcome"]

    def test_round_things_reach_their_seats(self):
        for kind in ("cone", "ball", "socket"):
            for clearance in (1, 0.01):
                with self.subTest(kind=kind, clearance=clearance):
                    self.assertEqual(self.outcome("seats", kind=kind, clearance=f"mm({clearance})", jump=5), "seated")

    def test_a_coaxial_pin_feels_none_of_what_its_voxels_make_up(self):
        """Free spin (ORACLES section 2), in one scene under both: turned against the grid, 50 um of clearance."""
        scenario = self.write("coaxial.lua", """
            local p = params{ hybrid = "off", height = 0.05 }
            defineSimulationParameters{ hybrid = p.hybrid, integrator = "implicit", duration = 0.001, passiveContacts = false,
                                        allBodiesAreDynamic = true }
            addObject{ name = "block", fixed = true, voxelsize = mm(4.5), density = 7800,
                       Solid.box{0.375, 0.375, 0.2} - Solid.cylinder{radius = mm(75), height = 0.2} }
            addObject{ name = "pin", voxelsize = mm(4.5), density = 7800, position = {0, 0, p.height},
                       orientation = AngleAxis(deg(20), Axis{0, 0, 1}),
                       Solid.cylinder{radius = mm(74.95), height = 0.4} }""")
        felt = {}
        for hybrid, height in (("off", 0.05), ("off", 0.201), ("exact", 0.05), ("exact", 0.201)):
            self.succeed("run", scenario, "-o", self.path("run.h5"), "--set", f"hybrid={hybrid}", "--set",
                         f"height={height}")
            with h5py.File(self.path("run.h5")) as f:
                wrench = dense(f, "block", "pin", "wrench")[0]
            felt[hybrid] = numpy.maximum(felt.get(hybrid, 0), numpy.abs(wrench[[2, 5]]))  # along and about the axis
        self.assertGreater(felt["off"][0], 1, "N; off feels nothing either: this would prove nothing")
        self.assertGreater(felt["off"][1], 1, "N m")
        self.assertTrue((felt["exact"] <= 1e-6 * felt["off"]).all(), felt)

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
