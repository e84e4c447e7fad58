"""Under the sanitizers: the start of every scene of this folder, so that what they look for is found in the code that runs.

What comes of the scenes is judged in the usual build, by the other tests of this folder.
"""
import glob
import json
import os
import subprocess
import unittest

import h5py

from scene_test import HERE, VERISIM, SceneTest

KINDS = {"resting_kinds.lua": {"kind": ("box", "sphere", "spherecone", "bowl", "cylside", "vgroove", "bowlcyl", "puck", "incline")},
         "conforming.lua": {"kind": ("tube", "socket", "cone", "bowl", "bore", "plug", "ring")},
         "entry.lua": {"kind": ("round", "oct", "hex", "square", "tri")},
         "press.lua": {"wall": ("flat", "cone", "tube", "socket")}}


class ScenesRun(SceneTest):
    def run_start(self, scene, **settings):
        with self.subTest(scene=scene, **settings):
            self.run_scene(scene, seconds=0.15, **settings)
            with h5py.File(self.run_file) as f:  # a kind that the scene does not know leaves it empty
                self.assertGreater(len(f.get("state/body", ())), 0)

    @staticmethod
    def has_hybrid(scene):
        command = [VERISIM, "run", os.path.join(HERE, scene), "--parameters", "--json"]
        done = subprocess.run(command, capture_output=True, text=True, check=True)
        return "hybrid" in [p["name"] for p in json.loads(done.stdout)["parameters"]]

    def test_every_scene_by_voxels_and_by_precise_surfaces(self):
        scenes = sorted(os.path.basename(path) for path in glob.glob(os.path.join(HERE, "*.lua")))
        self.assertGreater(len(scenes), 10)
        for scene in scenes:
            if scene != "nut.lua":  # other people's meshes: cli.fallback runs some
                for method in ({"hybrid": "restore"}, {"hybrid": "exact"}) if self.has_hybrid(scene) else ({},):
                    self.run_start(scene, **method)

    def test_every_kind_of_seat(self):
        for scene, choices in KINDS.items():
            for name, values in choices.items():
                for value in values:
                    self.run_start(scene, **{name: value})


if __name__ == "__main__":
    unittest.main()
