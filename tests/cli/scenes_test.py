"""The shipped scenarios: a golden hash and golden physical facts each. A hash changes only in a commit that says which
behaviour changed and why; VERISIM_GOLDEN=1 prints what is measured."""
import os
import statistics
import unittest


from program import turned_stl, ProgramTest, SHARED, SOURCE

MODELS = os.path.join(SHARED, "models")


class Scenes(ProgramTest):
    def scene(self, name, *options, run_file=None):
        run_file = self.path(run_file or name + ".h5")
        summary = self.run_json("run", os.path.join(SOURCE, "scenarios", name + ".lua"), "-o", run_file, *options)
        self.succeed("replay", run_file, "--verify")
        if os.environ.get("VERISIM_GOLDEN"):
            print(f"\n{name} {options}: {summary['state_hash']} {summary['outcome']}, {summary['collision_frames']} "
                  f"collision frames, {summary['measures']}")
        return summary

    def test_peg_in_hole(self):
        s = self.scene("peg_in_hole")
        self.assertEqual(s["frames"], 45833)
        self.assertGreaterEqual(s["collision_frames"], 11053)  # the dissertation's trial
        self.assertEqual(s["outcome"], "inserted")
        self.assertGreaterEqual(s["measures"]["passes"]["value"], 3)
        self.assertLess(s["max_penetration_m"], 0.0045)
        # The whole way of the dissertation's method: what was looked up, remembered and recognized.
        self.assertGreater(s["constraints"]["cylindrical"], 10000)
        self.assertEqual(s["cache_hits"] + s["cache_misses"], s["collisions"])
        self.assertGreater(s["cache_misses"], 0)

    def test_peg_in_hole_with_half_a_voxel_of_clearance(self):
        """Every approach lands on the rim. What guides the pin in there must not be taken for friction: if it is, the
        pin glides off and falls over."""
        depth = {"off": [], "restore": []}
        for seed in "123456":
            fit = ["--set", "clearance=mm(1)", "--set", "voxelsize=mm(2)", "--duration", "4", "--seed", seed]
            off, restore = (self.scene("peg_in_hole", *fit, "--set", "hybrid=" + h) for h in depth)
            self.assertEqual(restore["measures"]["passes"]["value"], off["measures"]["passes"]["value"], seed)
            depth["off"].append(off["max_penetration_m"])
            depth["restore"].append(restore["max_penetration_m"])
        # Of one seed it is 1 to 2.5 mm, under both: that of a voxel, as it is met.
        self.assertLess(statistics.median(depth["restore"]), 1.1 * statistics.median(depth["off"]))

    def test_a_hole_that_is_misjudged_is_found_by_those_who_search(self):
        """20 mm beside a hole of 2 mm of clearance: 30 seeds of the whole trial are in the scenario's notes."""
        for seed in "34":
            for strategy in ("straight", "tilt", "spiral"):
                s = self.scene("peg_in_hole", "--set", "strategy=" + strategy, "--set", "approach=0.02", "--set", "clearance=0.002",
                               "--set", "hybrid=exact", "--duration", "13", "--seed", seed)
                passes = s["measures"]["passes"]["value"]
                if strategy == "straight":
                    self.assertEqual(passes, 0, seed)
                else:
                    self.assertGreaterEqual(passes, 1, (strategy, seed))

    def test_peg_in_hole_in_the_published_scripts_sizes(self):
        s = self.scene("peg_in_hole", "--set", "half=true", "--duration", "5")
        self.assertGreater(s["collision_frames"], 500)

    def test_peg_in_hole_step(self):
        s = self.scene("peg_in_hole_step", "--duration", "5")
        self.assertEqual(s["outcome"], "inserted")
        self.assertGreater(s["collision_frames"], 500)

    def test_slide(self):
        s = self.scene("slide")
        self.assertEqual(s["outcome"], "slid")
        self.assertLess(s["measures"]["height_max"]["value"], 0.003)    # never more than a voxel above the plate …
        self.assertGreater(s["measures"]["height_min"]["value"], -0.003)  # … or in it

    def test_stack(self):
        for integrator in ["semi-implicit", "implicit"]:
            self.assertEqual(self.scene("stack", "--set", "integrator=" + integrator)["outcome"], "stacked", integrator)

    @unittest.skipUnless(os.path.isdir(MODELS), "the shared models are not there")
    def test_assembly_of_real_parts(self):
        crank = [os.path.join(MODELS, "freecad_cc0", f) for f in ("crank_base.stp", "crank_disk.stp")]
        s = self.scene("assembly", "--set", "model=" + ",".join(crank), "--set", "part=2")
        self.assertTrue(s["outcome"].startswith("pulled"), s["outcome"])
        bearing = os.path.join(MODELS, "occt", "Axis_of_bearing.stp")
        s = self.scene("assembly", "--set", "model=" + bearing, "--set", "part=4", "--set", "direction={1,0,0}",
                       "--set", "voxelsize=mm(1)")
        self.assertGreater(s["frames"], 500)
        board = [os.path.join(MODELS, "nist_boards", f) for f in
                 ("taskboard-pegarray2-1.STL", "taskboard_round_peg-1.STL")]
        s = self.scene("assembly", "--set", "model=" + ",".join(board), "--set", "scale=0.001", "--set", "part=2")
        self.assertGreater(s["collision_frames"], 0)

    def test_assembly_named_from_the_current_folder_and_a_part_by_its_name(self):
        with open(os.path.join(SOURCE, "scenarios", "models", "peg_in_hole.step"), "rb") as model:
            self.write("mine.step", model.read())
        s = self.scene("assembly", "--set", "model=mine.step", "--set", "part=pin", "--duration", "0.1")
        self.assertEqual(s["frames"], 100)

    def test_head_tracking(self):
        s = self.scene("head_tracking")
        self.assertEqual(s["outcome"], "tracked")
        self.assertGreater(s["measures"]["head_known"]["value"], 0.99)

    def test_entities_declared_by_hand_do_what_those_of_the_solids_do(self):
        by_hand, solid = (self.scene("declared", "--set", "by=" + by, run_file=by + ".h5") for by in ("hand", "solid"))
        self.assertEqual(by_hand["outcome"], "inserted")
        self.assertGreater(by_hand["constraints"]["cylindrical"], 1000)
        for fact in ("constraints", "collision_frames", "state_hash"):
            self.assertEqual(by_hand[fact], solid[fact], fact)

    def test_parts_of_bare_triangles_are_recognized_once_their_faces_are_recovered(self):
        self.write("bush.stl", turned_stl(inner=10, outer=16, height=20))
        self.write("rod.stl", turned_stl(inner=0, outer=9.8, height=60))
        script = """
            local p = params{{ brep = true }}
            defineSimulationParameters{{ hybrid = "{}", duration = 0.6 }}
            addObject{{ name = "bush", fixed = true, voxelsize = mm(1),
                       Model{{ "bush.stl", scale = 0.001, brep = p.brep }} }}
            local rod = addObject{{ name = "rod", voxelsize = mm(1), position = {{0, 0, 0.041}}, density = 1000,
                                   Model{{ "rod.stl", scale = 0.001, brep = p.brep }} }}
            local hand = Devices.Hand{{ name = "hand", path = {{  -- into the bush, then against its wall
              {{position = {{0, 0, 0.041}}}}, {{position = {{0, 0, 0.02}}, speed = 0.1}},
              {{position = {{0.001, 0, 0.02}}, speed = 0.02}} }} }}
            addDevice(hand)
            grasp(hand, rod)"""
        known = self.run_json("run", self.write("exact.lua", script.format("exact")), "-o", self.path("exact.h5"))
        self.assertGreater(known["collision_frames"], 100)
        self.assertLess(known["max_penetration_m"], 0.025 * 0.0002)  # of the clearance; voxels measure 1 mm
        scenario = self.write("restore.lua", script.format("restore"))
        known = self.run_json("run", scenario, "-o", self.path("known.h5"))
        self.assertGreater(known["constraints"].get("cylindrical", 0), 100)
        self.succeed("replay", self.path("known.h5"), "--verify")
        bare = self.run_json("run", scenario, "-o", self.path("bare.h5"), "--set", "brep=false")
        self.assertEqual(bare["constraints"], {})

    def test_golden_hashes(self):
        for name, options, golden in GOLDEN:
            summary = self.scene(name, *options)
            self.assertEqual(summary["state_hash"], golden, name)


GOLDEN = [
    ("peg_in_hole", ["--duration", "3"], "7cdec37d33ec6a8c"),
    ("peg_in_hole", ["--duration", "3", "--set", "hybrid=off"], "4bbc85249db629e9"),
    ("peg_in_hole_step", ["--duration", "3"], "bdf098e6627aed65"),
    ("head_tracking", [], "9dc6228fdeca4707"),
    ("slide", [], "f39e8a0886e200d2"),
    ("stack", [], "b2c06a22cbdf48ac"),
]

if __name__ == "__main__":
    unittest.main()
