"""`verisim inspect SCENARIO.lua`: what it says before a run is what the run then does."""
import glob
import os
import unittest

import h5py

from program import SOURCE, ProgramTest

SCENES = os.path.join(SOURCE, "scenarios")
FAR = """
defineSimulationParameters{ hybrid = "restore", duration = 0.5 }
addObject{ name = "plate", fixed = true, voxelsize = 0.005, Solid.box{0.1, 0.1, 0.02} }
addObject{ name = "far", fixed = true, voxelsize = 0.005, position = {5, 0, 0}, Solid.box{0.1, 0.1, 0.02} }
local box = addObject{ name = "box", voxelsize = 0.005, position = {0, 0, 0.1}, Solid.box{0.03, 0.03, 0.03} }
local hand = Devices.Hand{ name = "hand", path = { {position = {0, 0, 0.1}}, {position = {0, 0, 0.02}, speed = 0.5} } }
addDevice(hand) grasp(hand, box)
"""


class Inspect(ProgramTest):
    def met(self, path, *options):
        """The pairs that came near in a run."""
        self.succeed("run", path, "-o", self.path("run.h5"), "--force", "--quiet", *options)
        with h5py.File(self.path("run.h5")) as f:
            near = [e["text"].decode().split("'") for e in f["events"] if e["kind"] == b"near"]
        return {frozenset((text[1], text[3])) for text in near}

    def test_only_pairs_that_it_names_come_near(self):
        for name in ("peg_in_hole", "stack", "iso_fit", "seats", "pins", "reach", "slide"):
            with self.subTest(name):
                path = os.path.join(SCENES, name + ".lua")
                plan = self.run_json("inspect", path)
                met = self.met(path, "--duration", "1")
                can_meet = {frozenset(pair) for pair in plan["pairs"]}
                self.assertLessEqual(met, can_meet)
                prepared = {body["name"]: body["prepared"] for body in plan["bodies"]}
                for pair in met:
                    for body in pair:
                        self.assertNotEqual(prepared[body], "never")
                for body in plan["bodies"]:
                    self.assertEqual(body["prepared"] == "never", not any(body["name"] in pair for pair in can_meet))
                    self.assertEqual(body["memory_bytes"] > 0, body["prepared"] != "never")

    def test_every_shipped_scene_can_be_asked(self):
        for path in sorted(glob.glob(os.path.join(SCENES, "*.lua"))):
            with self.subTest(os.path.basename(path)):
                with open(path) as f:
                    if "addObject" not in f.read():
                        continue
                plan = self.run_json("inspect", path)
                self.assertEqual(plan["scenario"], os.path.basename(path))
                self.assertIsInstance(plan["parameters"], dict)
                self.assertGreater(len(plan["bodies"]), 0)

    def test_what_nothing_reaches_is_never_prepared(self):
        path = self.write("far.lua", FAR)
        plan = {body["name"]: body for body in self.run_json("inspect", path)["bodies"]}
        self.assertEqual({name: body["prepared"] for name, body in plan.items()},
                         {"plate": "when near", "far": "never", "box": "at the start"})
        self.assertEqual(plan["far"]["why"], "nothing that moves can come near it")
        self.assertIn("may meet 'plate'", plan["box"]["why"])
        text = self.succeed("inspect", path).stdout
        self.assertIn("nothing that moves can come near it", text)

    def test_it_refuses_what_a_run_refuses_and_options_of_the_other_kind(self):
        self.refuse(3, ["voxel"], "inspect", self.write("bad.lua", FAR.replace("voxelsize = 0.005, Solid.box{0.1", "voxelsize = -1, Solid.box{0.1")))
        self.refuse(3, ["no such file"], "inspect", self.path("none.lua"))
        self.assertIn("plate", self.succeed("inspect", self.write("FAR.LUA", FAR)).stdout)
        self.refuse(3, ["no parameter 'b'"], "inspect", self.write("far.lua", "params{a=1}\n" + FAR), "--set", "b=1")
        self.refuse(2, ["--voxel", "scenario"], "inspect", self.path("far.lua"), "--voxel", "0.001")
        self.refuse(2, ["--set", "model"], "inspect", "x.stl", "--set", "a=1")


if __name__ == "__main__":
    unittest.main()
