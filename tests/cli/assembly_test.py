"""Assemblies from STEP files: the roller bearing that the project ships (scenarios/models/make_models.cpp), and what
other people drew. What each method can tell apart is the point: `exact` a slide fit from a press fit, `restore` what
has a voxel of room from what has not."""
import os
import unittest

from program import ProgramTest, SHARED, SOURCE

MODELS = os.path.join(SHARED, "models")
SEEDS = (1, 2, 3)
LOOSE = {"instead": "models/shaft_loose.step", "voxelsize": "mm(0.7)"}  # 0.7 mm of room on the radius
PRESSED = {"instead": "models/shaft_m6.step"}
ONLY_BEARING = {"part": "bearing", "without": "shaft"}


class Assemblies(ProgramTest):
    def assemble(self, seed=1, *options, **settings):
        """Brings the held part to its place; the summary."""
        words = [w for key, value in {"way": "in", **settings}.items() for w in ("--set", f"{key}={value}")]
        return self.run_json("run", os.path.join(SOURCE, "scenarios", "assembly.lua"), "-o", self.path("run.h5"),
                             "--seed", seed, *words, *options)

    def assert_ends(self, outcome, seed, **settings):
        summary = self.assemble(seed, **settings)
        self.assertEqual(summary["outcome"], outcome, (settings, seed, summary["measures"]))
        return summary

    def test_inspect_names_the_parts_and_the_fits_of_the_shipped_bearing(self):
        report = self.run_json("inspect", os.path.join(SOURCE, "scenarios", "models", "bearing.step"))
        names = [part["name"] for part in report["parts"]]
        self.assertEqual(names, ["housing", "bearing outer ring", "bearing inner ring"] +
                         [f"bearing roller {i}" for i in range(1, 12)] + ["shaft"])
        fits = {(m["part_a"], m["part_b"]): 1e6 * m["clearance_m"] for m in report["mates"] if m["clearance_m"] > 0}
        self.assertEqual(set(fits), {("bearing inner ring", "shaft"), ("housing", "bearing outer ring")})
        self.assertAlmostEqual(fits["bearing inner ring", "shaft"], 4.25, places=3)          # um, g6 in 20 0/-10
        self.assertAlmostEqual(fits["housing", "bearing outer ring"], 9.0, places=3)         # um, 47 0/-11 in H7

    def test_a_shaft_with_its_own_4_um_goes_in_under_exact(self):
        for seed in SEEDS:
            summary = self.assert_ends("assembled", seed, hybrid="exact")
            # Its shoulder lies on the ring as far as its tilt within the clearance allows: 2 x 4.25 um / 12 mm of the
            # bore between its corners, over the shoulder's radius of 12.5 mm.
            self.assertLess(abs(summary["measures"]["left"]["value"]), 2 * 4.25e-6 / 12 * 12.5 + 1e-6)
            self.assertLess(summary["max_penetration_m"], 1e-6)

    def test_a_pressed_shaft_stays_in_the_mouth_under_every_method(self):
        for hybrid in ("off", "restore", "exact"):
            for seed in SEEDS[:2]:
                summary = self.assert_ends("not assembled", seed, hybrid=hybrid, **PRESSED)
        # Two leads of 45 degrees lie on each other when the shaft's end is 1 mm less 9.75 um below the bore's corner.
        self.assertAlmostEqual(summary["measures"]["left"]["value"], 0.01700975, delta=1e-6)

    def test_a_shaft_with_a_voxel_of_room_goes_in_under_restore_and_exact_and_not_without_them(self):
        for seed in SEEDS:
            self.assert_ends("assembled", seed, hybrid="restore", **LOOSE)
            self.assert_ends("not assembled", seed, hybrid="off", **LOOSE)
        self.assert_ends("assembled", 1, hybrid="exact", **LOOSE)

    def test_the_bearing_goes_into_its_housing_as_one_body(self):
        summary = self.assert_ends("assembled", 1, hybrid="exact", **ONLY_BEARING)
        self.assertLess(abs(summary["measures"]["left"]["value"]), 1e-4)

    def test_every_run_of_it_is_the_same(self):
        for settings in ({"hybrid": "exact"}, {"hybrid": "restore", **LOOSE}):
            first = self.assemble(4, **settings)["state_hash"]
            self.assertEqual(self.assemble(4, "--threads", "2", **settings)["state_hash"], first)
            self.assertNotEqual(self.assemble(5, **settings)["state_hash"], first)
            self.succeed("replay", self.path("run.h5"), "--verify")

    def test_what_is_assembled_comes_out_and_goes_back(self):
        summary = self.assert_ends("pulled and returned", 1, hybrid="exact", way="out")
        self.assertGreater(summary["measures"]["pulled"]["value"], 0.05)

    @unittest.skipUnless(os.path.isdir(MODELS), f"no models of other people at {MODELS}: nothing was assembled")
    def test_a_drawn_shaft_of_no_clearance_goes_into_a_drawn_ball_bearing(self):
        """Both are drawn with 20 mm, line to line, with sharp corners: nobody may misjudge anything."""
        files = [os.path.join(MODELS, "freecad_cc0", f) for f in ("bearing_20x37x9.stp", "axis.stp")]
        drawn = {"model": ",".join(files), "part": "axis", "place": "{0.009,0,0}", "direction": "{1,0,0}",
                 "distance": 0.05, "error": 0, "tilt": 0, "tremor": 0}
        for hybrid in ("restore", "exact"):
            self.assert_ends("assembled", 1, hybrid=hybrid, **drawn)
        self.assert_ends("not assembled", 1, hybrid="off", **drawn)

    def test_says_what_it_cannot_use(self):
        scenario = os.path.join(SOURCE, "scenarios", "assembly.lua")
        for words, setting in [(["15 parts", "'wheel'"], "part=wheel"), (["'up'", "in, out"], "way=up"),
                               ("direction", "direction={0,0,0}"), ("nowhere.step", "model=nowhere.step"),
                               ("nowhere.step", "instead=nowhere.step")]:
            self.refuse(3, words, "run", scenario, "-o", self.path("x.h5"), "--set", setting)


if __name__ == "__main__":
    unittest.main()
