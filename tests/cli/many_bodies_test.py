"""Scenes of hundreds of bodies: they start, run and leave a file; what pairs record stands in one table."""
import json
import os
import subprocess
import unittest

import h5py
import numpy

from program import SMALL, VERISIM, ProgramTest, dense, turned_stl

GRID = """
local p = params{ bodies = 48, moving = 48, pitch = 0.03, spin = 0, duration = 0.02 }
defineSimulationParameters{ allBodiesAreDynamic = true, gravity = {0, 0, -9.81}, duration = p.duration, hybrid = "off" }
local side = math.ceil(p.bodies ^ (1 / 3))
for i = 0, p.bodies - 1 do
  addObject{ name = "b" .. i, density = 1000, voxelsize = 0.004, fixed = i >= p.moving,
             position = {i % side * p.pitch, math.floor(i / side) % side * p.pitch, math.floor(i / side / side) * p.pitch},
             Solid.box{0.02, 0.02, 0.02} }
end
"""


FAR = """
local p = params{ far = 0, same = false, duration = 0.5 }
defineSimulationParameters{ allBodiesAreDynamic = true, gravity = {0, 0, -9.81}, duration = p.duration, hybrid = "off" }
addObject{ name = "floor", fixed = true, voxelsize = 0.005, position = {0, 0, -0.01}, Solid.box{0.3, 0.1, 0.02} }
for i = -1, 1 do
  addObject{ name = "box" .. i, density = 1000, voxelsize = 0.005, position = {i * 0.08, 0, 0.03}, Solid.box{0.02, 0.02, 0.02} }
end
for i = 1, p.far do
  local size = p.same and 0.02 or 0.02 + 0.0001 * i
  addObject{ name = "far" .. i, fixed = true, voxelsize = 0.005, position = {i * 0.1, 10, -3}, Solid.box{size, size, size} }
end
"""


class Far(ProgramTest):
    """A scene of 200 bodies of which 3 move costs what 3 cost: what is fixed and touched by nobody has no rows to write."""

    def far(self, far, **parameters):
        sets = [word for key, value in parameters.items() for word in ("--set", f"{key}={value}")]
        run_file = self.path(f"{far} {sorted(parameters.items())}.h5")
        return self.run_json("run", self.write("far.lua", FAR), "-o", run_file, "--set", f"far={far}", *sets), run_file

    def test_what_is_fixed_has_no_rows_on_disk_and_all_of_them_to_read(self):
        summary, run_file = self.far(197, same="true")
        with h5py.File(run_file) as f:
            frames = len(f["state/time"])
            self.assertEqual(frames, summary["frames"])
            for name, body in f["state/body"].items():
                pose, twist, force = body["pose"], body["twist"], body["force"]
                self.assertEqual((pose.shape, twist.shape, force.shape), ((frames, 7), (frames, 6), (frames, 6)))
                self.assertEqual((pose.dtype, twist.dtype, force.dtype), (float, float, float))
                if name.startswith("box"):
                    continue
                self.assertTrue((pose[()] == pose[0]).all() and not twist[()].any(), name)
                self.assertEqual(twist.id.get_num_chunks(), 0, name)
                self.assertLess(pose.id.get_storage_size(), 4096, name)
                if name.startswith("far"):
                    self.assertEqual(list(pose[frames - 1]), [int(name[3:]) * 0.1, 10, -3, 0, 0, 0, 1])
                    self.assertEqual(force.id.get_num_chunks(), 0, name)
                    self.assertFalse(force[()].any(), name)
            floor = f["state/body/floor/force"][()]
            self.assertFalse(floor[0].any())
            self.assertAlmostEqual(floor[-1, 2], -3 * 0.008 * 9.81, delta=1e-3)
        self.succeed("replay", run_file, "--verify", "--measure")

    def test_a_frame_more_takes_no_byte_more_for_what_is_fixed(self):
        def bytes_of(far, duration):
            return os.path.getsize(self.far(far, same="true", duration=duration)[1])
        few = bytes_of(0, 4) - bytes_of(0, 1)
        many = bytes_of(197, 4) - bytes_of(197, 1)
        self.assertLess(many - few, 3000 * 197, "one byte a row; they have 152")

    def test_changed_on_disk_it_does_not_pass_verify(self):
        _, run_file = self.far(2, same="true", duration=0.05)
        for name, value in (("force", 1e-3), ("twist", 1e-9), ("pose", 7)):
            with h5py.File(run_file, "r+") as f:
                before = f[f"state/body/far2/{name}"][20, 1]
                f[f"state/body/far2/{name}"][20, 1] = value
            self.refuse(1, ["frame 20", f"/state/body/far2/{name}[1]"], "replay", run_file, "--verify")
            with h5py.File(run_file, "r+") as f:
                f[f"state/body/far2/{name}"][20, 1] = before
        self.succeed("replay", run_file, "--verify")

    def test_one_program_makes_all_solids(self):
        log, cad = self.path("log"), self.path("cad")
        with open(cad, "w") as f:
            f.write(f"#!/bin/sh\necho started >> '{log}'\nexec '{os.path.join(os.path.dirname(VERISIM), 'verisim-cad')}' \"$@\"\n")
        os.chmod(cad, 0o755)
        environment = {**os.environ, "VERISIM_CAD": cad}
        done = self.run_program("run", self.write("far.lua", FAR), "-o", self.path("run.h5"), "--set", "far=30", "--set",
                                "duration=0.01", "--no-cache", env=environment)
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(log) as f:
            self.assertEqual(f.read(), "started\n")


class ManyBodies(ProgramTest):
    def grid(self, **parameters):
        """Summary and run file of a grid of boxes."""
        run_file = self.path("run.h5")
        sets = [word for key, value in parameters.items() for word in ("--set", f"{key}={value}")]
        summary = self.run_json("run", self.write("grid.lua", GRID), "-o", run_file, *sets)
        return summary, run_file

    def test_every_number_of_free_bodies_leaves_its_file(self):
        for bodies in (1, 2, 20, 48, 80, 300):
            summary, run_file = self.grid(bodies=bodies, moving=bodies)
            with h5py.File(run_file) as f:
                self.assertEqual(len(f["state/body"]), bodies)
                self.assertEqual(f["state/time"].shape, (summary["frames"],))
                self.assertEqual(f["cost/links"][()].sum(), len(f["state/links/frame"]))
                self.assertEqual(f["cost/pairs_met"][()].sum(), len(f["state/pairs"]))

    def test_nine_hundred_fixed_bodies_and_one_that_moves(self):
        summary, run_file = self.grid(bodies=901, moving=1)
        with h5py.File(run_file) as f:
            self.assertEqual(summary["frames"], len(f["state/time"]))
            self.assertTrue(all(b"b0" in tuple(pair) for pair in f["state/pairs"][()]), "of the one that moves")

    def test_a_thousand_bodies_of_which_three_move_start_soon_and_small(self):
        scenario = self.write("grid.lua", GRID)
        run = subprocess.Popen([VERISIM, "run", scenario, "-o", self.path("run.h5"), "--json", "--set", "bodies=1000",
                                "--set", "moving=3", "--set", "pitch=0.021"], stdout=subprocess.PIPE)
        summary = json.loads(run.stdout.read())
        _, status, used = os.wait4(run.pid, 0)
        run.returncode = status
        run.stdout.close()
        self.assertEqual(status, 0)
        self.assertLess(summary["load_s"], 5)
        self.assertLess(used.ru_maxrss, 500e3, "kB")
        self.assertGreater(summary["collision_frames"], 0)

    def test_bodies_fall_together_and_pay_for_what_is_near(self):
        summary, run_file = self.grid(bodies=64, pitch=0.0201, duration=0.05)
        with h5py.File(run_file) as f:
            pairs, links, frames = len(f["state/pairs"]), len(f["state/links/frame"]), summary["frames"]
            self.assertGreater(pairs, 100)
            self.assertLess(pairs, 64 * 63 / 2)
            self.assertLessEqual(links, pairs * frames)
            keys = f["state/links/frame"][()].astype(numpy.int64) * pairs + f["state/links/pair"][()]
            self.assertEqual(len(numpy.unique(keys)), links, "a pair has one row in a frame")
            self.assertTrue((numpy.diff(f["state/links/frame"][()].astype(int)) >= 0).all(), "sorted by frame")
            near = [e for e in f["events"] if e["kind"] == b"near"]
            self.assertEqual(len(near), pairs)

    def test_a_paced_run_makes_all_before_and_records_the_same(self):
        scenario = self.write("grid.lua", GRID)
        files = [self.path("free.h5"), self.path("paced.h5")]
        options = ["--set", "bodies=27", "--set", "moving=9", "--set", "pitch=0.022", "--set", "duration=0.1"]
        for file, paced in zip(files, ([], ["--realtime"])):
            self.succeed("run", scenario, "-o", file, *options, *paced)
        with h5py.File(files[0]) as free, h5py.File(files[1]) as paced:
            self.assertEqual(free.attrs["state_hash"], paced.attrs["state_hash"])
            for name in ("events", "state/pairs", "state/links/frame", "state/links/wrench", "cost/pairs_met"):
                self.assertEqual(free[name][()].tobytes(), paced[name][()].tobytes(), name)

    def test_a_body_that_cannot_be_made_when_it_is_met_ends_the_run_with_its_file(self):
        """Within its reach everything is checked before the first frame; where a script puts a body is not foreseen."""
        scenario = self.write("far.lua", """
            defineSimulationParameters{ duration = 0.1 }
            addObject{ name = "far", fixed = true, voxelsize = 3, position = {50, 0, 0}, Solid.box{0.1, 0.1, 0.1} }
            local box = addObject{ name = "box", voxelsize = 0.01, Solid.box{0.1, 0.1, 0.1} }
            local hand = Devices.Hand{ name = "hand", path = { {position = {0, 0, 0}} } }
            addDevice(hand)
            grasp(hand, box)
            Actions.addFrameAction(function()
              Actions.waitSeconds(0.05)
              box.position = {50, 0, 0.02}
            end)""")
        run_file = self.path("far.h5")
        done = self.run_program("run", scenario, "-o", run_file)
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn("error: far: voxelsize is 3 m", done.stderr)
        with h5py.File(run_file) as f:
            self.assertGreaterEqual(len(f["state/time"]), 50)
            self.assertEqual(f["summary"].attrs["frames"], len(f["state/time"]))


class FormatOne(ProgramTest):
    """Files of format 1: dense columns for every pair that could meet, under /state/link."""

    def as_format_1(self, run_file):
        """Writes a run file of one pair as the first version did."""
        with h5py.File(run_file, "r+") as f:
            (pair,) = f["state/pairs"][()]
            first, second = pair["first"].decode(), pair["second"].decode()
            for fact in f["state/links"]:
                if fact in ("frame", "pair", "by_voxels"):
                    continue
                old = f[f"state/links/{fact}"]
                new = f.create_dataset(f"state/link/{first}~{second}/{fact}", data=dense(f, first, second, fact),
                                       dtype=old.dtype)
                for key in ("units", "description", "order", *(["names"] if "names" in old.attrs else [])):
                    new.attrs[key] = old.attrs[key]
            events, attributes = f["events"][()], dict(f["events"].attrs)
            for name in ("events", "state/links", "state/pairs", "cost/links", "cost/pairs_met"):
                del f[name]
            later = [e["kind"] in (b"near", b"voxels") or b"have no b-rep" in e["text"] for e in events]
            f.create_dataset("events", data=events[~numpy.array(later)]).attrs.update(attributes)
            columns = []  # the state first, then its hash, then all else
            f.visititems(lambda name, item: columns.append((not name.startswith("state"), name == "state/hash", name))
                         if "order" in item.attrs and not name.startswith("inputs") else None)
            for order, (_, _, name) in enumerate(sorted(columns)):
                f[name].attrs["order"] = numpy.int64(order)
            f.attrs["columns"] = numpy.int64(len(columns))
            f.attrs["format_version"] = numpy.int64(1)
            del f.attrs["checksums"]

    def test_is_read_replayed_and_verified(self):
        run_file = self.path("run.h5")
        summary = self.run_json("run", self.write("small.lua", SMALL), "-o", run_file)
        self.assertGreater(summary["collision_frames"], 0)
        self.as_format_1(run_file)
        done = self.succeed("replay", run_file, "--verify")
        self.assertIn("format 1", done.stderr)
        with h5py.File(run_file, "r+") as f:
            (name,) = f["state/link"]
            f[f"state/link/{name}/wrench"][-1, 2] += 1
        self.refuse(1, ["/state/links/wrench of plate~box[2]", f"frame {summary['frames'] - 1}"], "replay", run_file,
                    "--verify")

    def test_told_of_pairs_of_which_one_body_has_no_b_rep_and_of_no_others(self):
        self.write("bush.stl", turned_stl(inner=10, outer=16, height=20))
        script = """
            defineSimulationParameters{ hybrid = "restore" }
            addObject{ name = "bush", fixed = true, voxelsize = mm(1), Model{ "bush.stl", scale = 0.001 } }
            local rod = addObject{ name = "rod", voxelsize = mm(1), position = {0, 0, 0.02}, brep = BREP,
                                   Solid.cylinder{radius = 0.0098, height = 0.06} }
            local hand = Devices.Hand{ name = "hand", path = { {position = {0.0005, 0, 0.02}, dwell = 0.1} } }
            addDevice(hand)
            grasp(hand, rod)"""
        for brep, told in (("true", 1), ("false", 0)):
            run_file = self.path(brep + ".h5")
            self.run_json("run", self.write("it.lua", script.replace("BREP", brep)), "-o", run_file)
            self.as_format_1(run_file)
            with h5py.File(run_file) as f:
                self.assertEqual([e["kind"] for e in f["events"]].count(b"hybrid"), told)
            self.succeed("replay", run_file, "--verify")


if __name__ == "__main__":
    unittest.main()
