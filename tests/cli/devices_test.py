"""A device that nobody holds, a trace that is made for it, and what its bubble does with it: `scenarios/reach.lua`."""
import json
import os
import unittest

import h5py
import numpy

from program import SOURCE, ProgramTest

SCENE = os.path.join(SOURCE, "scenarios", "reach.lua")


class Devices(ProgramTest):
    def run_reach(self, *options):
        self.succeed("run", SCENE, "--quiet", "-o", "reach.h5", "--force", *options)
        with h5py.File(self.path("reach.h5")) as f:
            device = {name: f["state/device/omni/" + name][()] for name in f["state/device/omni"]}
            return device, [(e["kind"].decode(), e["text"].decode()) for e in f["events"]], f["state/body/box/pose"][()]

    def hold(self):
        self.succeed("trace", "synth", "reach", "-o", self.path("reach.csv"), "--force", "--set", "to_x=0.07", "--set", "time=2",
                     "--set", "wait=1")
        return ["--bind", "omni=" + self.path("reach.csv")]

    def test_without_a_trace_it_stays_at_home_and_says_so(self):
        done = self.succeed("run", SCENE, "--duration", "0.1", "-o", "home.h5", "--force")
        self.assertIn("device 'omni' is driven by nothing", done.stderr)

    def test_a_bubble_carries_farther_than_the_device_reaches(self):
        device, events, box = self.run_reach(*self.hold())
        self.assertLessEqual(device["raw_pose"][:, 0].max(), 0.0701)  # and 0.7 m scaled
        self.assertGreater(box[:, 0].max(), 1.8)
        # The handle is the hardware's, scaled, and the bubble's centre.
        handle = 10 * device["raw_pose"][:, :3] + device["bubble_center"]
        self.assertLessEqual(numpy.abs(handle - device["handle_pose"][:, :3]).max(), 1e-12)
        # Outside of 0.45 m, and there alone, it moves: its velocity is the centre's.
        outside = numpy.linalg.norm(10 * device["raw_pose"][:, :3], axis=1) > 0.45
        self.assertEqual((device["outside"] == 1).tolist(), outside.tolist())
        moved = numpy.diff(device["bubble_center"], axis=0) / 1e-3
        self.assertLessEqual(numpy.abs(moved - device["bubble_velocity"][:-1]).max(), 1e-9)
        self.assertEqual(numpy.any(device["bubble_velocity"] != 0, axis=1).tolist(), outside.tolist())
        kinds = [kind for kind, _ in events]
        self.assertIn("collision", kinds)
        self.assertIn(("device", "omni (a recorded trace), through omni (Phantom Omni, 3.3 N, no torques, steps of 5.5e-05 m), "
                                 "scaled by 10, in a bubble of 0.45 m (peak-ring law, scale 1.5, 50 N/m)"), events)

    def test_saturation_is_a_column_and_an_event_when_it_begins_and_ends(self):
        device, events, _ = self.run_reach(*self.hold())
        said = [text for kind, text in events if kind == "saturation"]
        changes = numpy.flatnonzero(numpy.diff(numpy.concatenate([[0], device["saturated"].astype(int)])))
        self.assertGreater(len(changes), 0)
        self.assertEqual(len(said), len(changes))
        force = numpy.linalg.norm(device["wrench"][:, :3], axis=1)
        self.assertLessEqual(force.max(), 3.3 * (1 + 1e-12))
        self.assertEqual((device["saturated"] == 1).tolist(), (force > 3.3 * (1 - 1e-12)).tolist())

    def test_the_way_back_is_what_the_poses_tell(self):
        for law, device in (("cubic", "virtuose"), ("peak-ring", "omni"), ("quadratic", "omni")):
            with self.subTest(law=law, device=device):
                done = self.succeed("run", os.path.join(SOURCE, "scenarios", "bubble_stickiness.lua"), "--json", "--quiet", "-o",
                                    "stick.h5", "--force", "--set", "law=" + law, "--set", "device=" + device,
                                    "--set", "surprise=0.5", "--seed", "2")
                report = json.loads(done.stdout)
                self.assertEqual(report["outcome"], "released")
                with h5py.File(self.path("stick.h5")) as f:
                    raw = f[f"state/device/{device}/raw_pose"][:, 0]
                    center = f[f"state/device/{device}/bubble_center"][:, 0]
                    box = f["state/body/box/pose"][:, 0]
                    touching = numpy.flatnonzero(f["state/body/box/force"][:].any(axis=1))
                first, last = touching[0], touching[-1]
                # The wall stands at 3 m, the box has sides of 0.2 m: where a force is, it touches within the step.
                self.assertLessEqual(abs(box[touching - 1] - 2.9).max(), 1e-3)
                self.assertLess(box[last + 1:].max(), 2.9)
                # The script sees a frame's contacts a frame later or earlier than the row that they stand in.
                frames = slice(last - 1, last + 2)
                scale = 3.2 if device == "virtuose" else 10
                for name, wanted in (("way back", raw[first:].max() - raw[frames]),
                                     ("bubble moved", (center[frames] - center[first]) / scale),
                                     ("time to the wall", numpy.array([first, first + 1]) / 1000)):
                    here = report["measures"][name]["value"]
                    self.assertTrue(wanted.min() - 2e-4 <= here <= wanted.max() + 2e-4, (name, here, wanted))

    def test_a_trace_that_jumps_is_told_and_ends_where_it_ends(self):
        def trace(*rows):
            with open(self.path("jump.csv"), "w") as f:
                f.write("# verisim-trace 1\n# kind: haptic\n# rate_hz: 10\n# source: a test\nt,px,py,pz,qx,qy,qz,qw,button\n")
                f.writelines("%g,%g,0,0,%g,0,0,%g,1\n" % (0.1 * i, *row) for i, row in enumerate(rows))
            return "omni=" + self.path("jump.csv")

        still = (0.02, 0, 1)
        for name, rows in (("10 m", [still, (10.02, 0, 1), still]), ("half a turn", [still, (0.02, 1, 0), still] * 3),
                           ("both, and back in a frame", [still, (10.02, 1, 0), still, (-10, 0, 1), still])):
            with self.subTest(name):
                device, events, box = self.run_reach("--bind", trace(*rows), "--duration", "3")
                said = [text for kind, text in events if kind in ("speed", "trace")]
                self.assertTrue(any("it jumps" in text for text in said) or name == "half a turn", said)
                self.assertTrue(any("has no more samples" in text for text in said), said)
                self.assertTrue(numpy.isfinite(box).all())
                # The box rests where the trace ends: as far from the handle as it was grasped.
                apart = box[:, :3] - device["handle_pose"][:, :3]
                self.assertLessEqual(numpy.linalg.norm(apart[-1] - apart[0]), 1e-3)
                self.assertLessEqual(numpy.linalg.norm(numpy.diff(box[-100:, :3], axis=0), axis=1).max(), 1e-6)

    def test_a_button_that_is_stuck_or_chatters(self):
        free = self.path("free.lua")
        with open(free, "w") as f:
            f.write("""addObject{ name = "wall", fixed = true, voxelsize = 0.02, position = {0.3, 0, 0}, Solid.box{0.1, 1, 1} }
                addObject{ name = "box", voxelsize = 0.02, Solid.box{0.1, 0.1, 0.1} }
                addDevice(Devices.Replay{ name = "hand", trace = "hand.csv" })""")
        for name, down, held in (("down", lambda i: 1, True), ("up", lambda i: 0, False),
                                 ("chatters", lambda i: i % 2, True), ("lets go", lambda i: i < 20, True)):
            with self.subTest(name), open(self.path("hand.csv"), "w") as f:
                f.write("# verisim-trace 1\n# kind: haptic\n# rate_hz: 100\n# source: a test\nt,px,py,pz,qx,qy,qz,qw,button\n")
                f.writelines("%g,%g,0,0,0,0,0,1,%d\n" % (0.01 * i, 0.005 * i, down(i)) for i in range(101))
                f.close()
                self.succeed("run", free, "--quiet", "-o", "free.h5", "--force")
                with h5py.File(self.path("free.h5")) as run:
                    box = run["state/body/box/pose"][:, :3]
                    said = [e["text"].decode() for e in run["events"] if e["kind"] == b"button"]
                self.assertEqual([text.split(":")[0] for text in said],
                                 [f"hand has a button that is {name} in every sample"] if name in ("down", "up") else [])
                self.assertEqual(numpy.abs(box).max() > 0.05, held)
                self.assertTrue((box[:, 0] < 0.21).all())  # the wall stands at 0.25 m; the hand goes on to 0.5
                self.assertLess(numpy.linalg.norm(numpy.diff(box, axis=0), axis=1).max() / 1e-3, 2)

    def test_a_bubble_that_stops_in_collision_goes_no_farther(self):
        ends = [self.run_reach(*self.hold(), "--set", "stop=" + stop)[0]["bubble_center"][:, 0].max() for stop in ("false", "true")]
        self.assertGreater(ends[0], ends[1] + 0.05)

    def test_its_runs_are_computed_again(self):
        self.run_reach(*self.hold(), "--set", "stop=true", "--set", "bump=2")
        self.succeed("replay", "reach.h5", "--verify")


if __name__ == "__main__":
    unittest.main()
