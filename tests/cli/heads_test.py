"""WiiHead in scenes: what the run file holds, and that the loop does not notice (INTERFACES section 2 and 3)."""
import csv
import os
import signal
import subprocess
import time
import unittest

import h5py
import numpy as np

from program import SOURCE, VERISIM, ProgramTest, dense
from wii_test import trace

SCENE = os.path.join(SOURCE, "scenarios", "head_tracking.lua")


class Heads(ProgramTest):
    def scene(self, *options, name="heads", duration=2):
        run_file = self.path(name + ".h5")
        summary = self.run_json("run", SCENE, "-o", run_file, "--duration", duration, *options)
        self.succeed("replay", run_file, "--verify")
        return h5py.File(run_file), summary

    def test_the_run_file_has_rows_of_the_remotes_own_times(self):
        run, summary = self.scene("--set", "sensor=ideal")
        head = run["state/wii/head"]
        self.assertEqual({name: head[name].shape for name in head},
                         {"time": (201,), "channels": (201, 16), "truth_pose": (201, 7), "estimate_pose": (201, 7),
                          "valid": (201,)})
        np.testing.assert_allclose(head["time"], np.arange(201) / 100, atol=1e-12)
        taken = np.flatnonzero(run["cost/wii/head/reports"])
        np.testing.assert_array_equal(taken[1:], np.arange(1, 201) * 10 - 1, "k / 100 s is the end of frame 10 k - 1")
        self.assertTrue(np.all(head["valid"]))
        error = np.linalg.norm(head["estimate_pose"][:, :3] - head["truth_pose"][:, :3], axis=1)
        self.assertLess(np.sqrt(np.mean(error ** 2)), 0.0045)
        self.assertEqual(summary["outcome"], "tracked")
        self.assertEqual(summary["measures"]["head_known"]["value"], 1)

    def test_the_loop_does_not_notice(self):
        with_head, _ = self.scene(name="with")
        without, _ = self.scene("--set", "watch=false", name="without")
        self.assertNotIn("wii", without["state"])
        self.assertNotIn("wii", without["cost"])
        compared = 0
        for folder in ["state/body", "state/device", "state/links"]:
            def compare(name, item, folder=folder):
                nonlocal compared
                if isinstance(item, h5py.Dataset):
                    self.assertEqual(item[()].tobytes(), with_head[folder][name][()].tobytes(), name)
                    compared += 1

            without[folder].visititems(compare)
        self.assertGreater(compared, 10)
        self.assertEqual(without["state/energy"][()].tobytes(), with_head["state/energy"][()].tobytes())
        self.assertGreater(np.count_nonzero(dense(without, "plate", "block", "contacts")), 500)

    def test_every_tracker_of_one_remote(self):
        for tracker in ["geometric", "three-led", "scaat", "vrpn-compatible"]:
            run, _ = self.scene("--set", "tracker=" + tracker, duration=0.5)
            self.assertGreater(np.mean(run["state/wii/head/valid"]), 0.9, tracker)

    def test_a_bound_trace_takes_the_place_of_the_virtual_remote(self):
        head = self.write("head.csv", trace("# fov_deg: 40 30", rows=50))
        run, _ = self.scene("--set", "tracker=geometric", "--bind", "head=" + head)
        got = run["state/wii/head"]
        self.assertEqual(got["time"].shape, (50,))
        self.assertTrue(np.all(np.isnan(got["truth_pose"])), "this trace does not know the truth")
        self.succeed("wii", "track", head, "--tracker", "geometric", "-o", self.path("pose.csv"))
        with open(self.path("pose.csv")) as f:
            rows = np.array([[float(x) for x in row[2:9]] for row in list(csv.reader(f))[1:]])
        self.assertEqual(rows.tobytes(), got["estimate_pose"][()].tobytes(), "in a scene as on the command line")
        self.assertIn("head.csv", " ".join(run["inputs/files"][n].attrs["name"] for n in run["inputs/files"]))

    def test_a_trace_gives_the_run_its_length_and_the_last_word_ages(self):
        self.write("head.csv", trace(rows=50))
        script = """
            addObject{ name = "plate", fixed = true, voxelsize = 0.01, Solid.box{0.3, 0.3, 0.02} }
            local head = WiiHead{ remote = "head.csv", tracker = "geometric" }
            Actions.addFrameAction(function()
              while true do
                measure("valid", head.valid and 1 or 0, "1")
                Actions.waitForRedraw()
              end
            end)"""
        _, summary = self.small_run(script=script)
        self.assertEqual(summary["frames"], 490)
        self.assertEqual(summary["measures"]["valid"]["value"], 1)
        _, summary = self.small_run("--duration", "1.2", script=script)
        self.assertEqual(summary["measures"]["valid"]["value"], 0, "0.5 s after the last report nothing is known")

    def test_a_killed_run_keeps_rows_that_fit_its_frames(self):
        run_file = self.path("killed.h5")
        process = subprocess.Popen([VERISIM, "run", SCENE, "-o", run_file, "--realtime", "--duration", "60", "--quiet"],
                                   cwd=self.folder)
        self.addCleanup(process.kill)
        while not os.path.exists(run_file):
            time.sleep(0.05)
        time.sleep(1)
        process.send_signal(signal.SIGKILL)
        process.wait()
        self.succeed("recover", run_file)
        with h5py.File(run_file) as run:
            counts = run["cost/wii/head/reports"][()]
            self.assertEqual(len(counts), len(run["state/time"]))
            for name in run["state/wii/head"]:
                self.assertEqual(len(run["state/wii/head"][name]), np.count_nonzero(counts), name)
            self.assertGreater(np.count_nonzero(counts), 20)
        self.succeed("replay", run_file, "--verify")

    def test_refuses_what_cannot_be_tracked(self):
        def scenario(head):
            return self.write("bad.lua", 'addObject{ name = "a", fixed = true, Solid.box{0.1, 0.1, 0.1} }\n' + head)

        def refuse(words, head, *options):
            self.refuse(3, ["bad.lua:2" if not options else "--bind", *words], "run", scenario(head), *options)

        refuse(["stereo", "two remotes"], 'WiiHead{ tracker = "stereo" }')
        refuse(["geometrik", "geometric"], 'WiiHead{ tracker = "geometrik" }')
        refuse(["naturl"], 'WiiHead{ remote = { motion = "naturl" } }')
        refuse(["wimote"], 'WiiHead{ remote = { sensor = "wimote" } }')
        refuse(["nowhere.csv"], 'WiiHead{ remote = "nowhere.csv" }')
        refuse(["leds"], "WiiHead{ leds = {{0, 0, 0}} }")
        refuse(["leds", "0.001 m apart"], "WiiHead{ leds = {{0, 0, 0}, {0, 0.001, 0}} }")
        refuse(["already"], "WiiHead{} WiiHead{}")
        refuse(["trackr", "tracker"], 'WiiHead{ trackr = "scaat" }')
        self.write("haptic.csv", "# verisim-trace 1\n# kind: haptic\n# rate_hz: 1\n# source: a test\n"
                                 "t,px,py,pz,qx,qy,qz,qw\n0,0,0,0,0,0,0,1\n")
        refuse(["haptic.csv", "wii"], "WiiHead{}", "--bind", "head=haptic.csv")


if __name__ == "__main__":
    unittest.main()
