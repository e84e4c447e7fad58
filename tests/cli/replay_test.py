"""A run file holds all that is needed to simulate again; what differs is found and named."""
import json
import os
import unittest

import h5py
import numpy

from program import turned_stl, ProgramTest, SMALL


class Replay(ProgramTest):
    def test_verify_needs_the_run_file_alone(self):
        run_file, summary = self.small_run()
        os.remove(self.path("small.lua"))
        text = self.succeed("replay", run_file, "--verify").stdout
        self.assertIn(summary["state_hash"], text)
        self.succeed("replay", run_file, "--verify", "--threads", "2", "--simd", "scalar")

    def test_events_and_prints_of_frame_actions_come_again(self):
        script = SMALL + """
Actions.addFrameAction(function()
  for i = 1, 5 do measure("i", i, "1"); outcome("step " .. i); Actions.waitForRedraw() end
  error("on purpose")
end)"""
        run_file, summary = self.small_run(script=script)
        self.assertEqual(summary["outcome"], "step 5")
        with h5py.File(run_file) as f:
            texts = [e["text"].decode() for e in f["/events"]]
        self.assertTrue(any("on purpose" in t and "small.lua" in t for t in texts), texts)
        self.succeed("replay", run_file, "--verify")

    def changed(self, change):
        run_file, _ = self.small_run()
        with h5py.File(run_file, "r+") as f:
            change(f)
        return run_file

    def test_the_first_differing_frame_and_field_are_named(self):
        def flip(f):
            bits = f["/state/body/box/twist"][123].view("uint64")
            bits[2] ^= numpy.uint64(1)
            f["/state/body/box/twist"][123] = bits.view("float64")
        self.refuse(1, ["frame 123", "/state/body/box/twist[2]"], "replay", self.changed(flip), "--verify")

    def test_costs_and_events_are_compared_too(self):
        def cost(f):
            f["/cost/points_tested"][7] += 1
        self.refuse(1, ["frame 7", "/cost/points_tested"], "replay", self.changed(cost), "--verify")

        def event(f):
            e = f["/events"][0]
            e["text"] = b"something else"
            f["/events"][0] = e
        self.refuse(1, "event 0", "replay", self.changed(event), "--verify")

    BALL = """
defineSimulationParameters{ allBodiesAreDynamic=true, gravity={0,0,-9.81}, duration=0.1, hybrid="off" }
addObject{ name="plate", fixed=true, voxelsize=0.002, Solid.box{0.1,0.1,0.02} }
addObject{ name="ball", voxelsize=0.002, density=2000, position={0.001,0.002,0.031}, Solid.sphere{radius=0.02} }"""

    def test_measure_gives_the_true_overlap_beside_the_recorded_one(self):
        """A ball over a plate overlaps it by its radius less its height over the plate's face, at 0.01 m."""
        run_file, summary = self.small_run(script=self.BALL)
        measured = json.loads(self.succeed("replay", run_file, "--verify", "--measure", "--json").stdout)["measured"]
        pair, = measured["pairs"]
        self.assertEqual((pair["first"], pair["second"], pair["source"]), ("plate", "ball", "solids"))
        with h5py.File(run_file) as f:
            height = f["/state/body/ball/pose"][:, 2]
            recorded = numpy.zeros(len(height))
            recorded[f["/state/links/frame"][:]] = f["/state/links/max_penetration"][:]
        truth = numpy.maximum(0, 0.03 - height)
        self.assertGreater(truth.max(), 1e-5, "the ball never sank in: this would prove nothing")
        self.assertTrue((numpy.array(pair["overlap_m"]) <= truth + 1e-12).all())
        self.assertTrue((truth <= numpy.array(pair["overlap_m"]) + numpy.array(pair["bound_m"]) + 1e-12).all())
        self.assertEqual(pair["recorded_m"], list(recorded[1:]))
        worst = measured["largest_difference"]
        self.assertEqual(worst["recorded_m"], pair["recorded_m"][worst["frame"]])
        self.assertEqual(worst["overlap_m"], pair["overlap_m"][worst["frame"]])
        self.assertIn("largest difference: plate ~ ball, frame %d" % worst["frame"],
                      self.succeed("replay", run_file, "--measure").stdout)
        self.assertEqual(summary["penetration_source"], "voxels")

    ROD = """
defineSimulationParameters{ gravity={0,0,-9.81}, allBodiesAreDynamic=true, duration=0.02, hybrid="exact" }
addObject{ name="plate", fixed=true, voxelsize=0.002, Solid.box{0.1,0.1,0.02} }
addObject{ name="rod", voxelsize=0.002, density=2000, position={0,0,0.02997},
           orientation=AngleAxis(math.pi/2, Axis{1,0,0}), Model{ "rod.stl", scale=0.001, brep=true } }"""

    def test_measure_tells_triangles_and_recovered_surfaces_apart(self):
        """A mesh of a rod of 20 mm radius lies on a plate with the middle of a facet: the cylinder reaches 30 um into it,
        the facets end 20 mm (1 - cos(pi/48)) = 43 um above that."""
        sides = 48
        self.write("rod.stl", self.turned_by_half_a_side(turned_stl(inner=0, outer=20, height=20, sides=sides), sides))
        run_file, _ = self.small_run(script=self.ROD)
        measured = json.loads(self.succeed("replay", run_file, "--measure", "--json").stdout)["measured"]
        pair, = measured["pairs"]
        self.assertEqual(pair["source"], "triangles")
        with h5py.File(run_file) as f:
            truth = 0.03 - f["/state/body/rod/pose"][0, 2]
        surfaces = pair["surfaces"]
        self.assertLessEqual(surfaces["overlap_m"][0], truth + 1e-6)
        self.assertGreaterEqual(surfaces["overlap_m"][0], truth - 1e-5)
        self.assertGreaterEqual(surfaces["overlap_m"][0] + surfaces["bound_m"][0], truth - 1e-6)
        self.assertLess(pair["overlap_m"][0] + pair["bound_m"][0], truth)
        self.assertRegex(self.succeed("replay", run_file, "--measure").stdout, r"plate ~ rod +triangles[^\n]*\nplate ~ rod +surfaces")

    @staticmethod
    def turned_by_half_a_side(stl, sides):
        """The same about z, so that a facet and no edge is farthest along y."""
        angle = numpy.pi / sides
        def turned(line):
            word, *numbers = line.split()
            if word != "vertex":
                return line
            x, y, z = map(float, numbers)
            return "vertex {:.9g} {:.9g} {:.9g}".format(x * numpy.cos(angle) - y * numpy.sin(angle),
                                                        x * numpy.sin(angle) + y * numpy.cos(angle), z)
        return "\n".join(map(turned, stl.splitlines())) + "\n"

    def test_without_embedded_inputs_there_is_nothing_to_replay(self):
        run_file, _ = self.small_run("--no-embed")
        self.refuse(3, "--no-embed", "replay", run_file)

    def test_a_flipped_bit_anywhere_is_found_or_harmless(self):
        """Flips one bit at a hundred places of the file (under the sanitizers at ten): replay never says equal for a file
        whose data differ, and never crashes. Padding, free space and wall clock may change unseen."""
        run_file, _ = self.small_run("--duration", "0.05")
        with open(run_file, "rb") as f:
            content = f.read()
        with h5py.File(run_file) as f:
            before = {k: f[k][()].tobytes() for k in ["/state/body/box/pose", "/state/hash", "/cost/contacts"]}
        damaged = self.path("damaged.h5")
        for i in range(10 if os.environ["VERISIM_SANITIZE"] else 100):
            at = (i * 2654435761 + 17) % len(content)
            with open(damaged, "wb") as f:
                f.write(content[:at] + bytes([content[at] ^ (1 << i % 8)]) + content[at + 1:])
            done = self.run_program("replay", damaged, "--verify")
            self.assertIn(done.returncode, [0, 1, 3], f"byte {at}: {done.stderr}")
            if done.returncode == 0:
                with h5py.File(damaged) as f:
                    for k, v in before.items():
                        self.assertEqual(f[k][()].tobytes(), v, f"byte {at}: {k}")

    def test_what_is_no_run_file_is_refused(self):
        with h5py.File(self.path("other.h5"), "w") as f:
            f["x"] = 1
        for name, content in [("empty.h5", b""), ("garbage.h5", b"\x89HDF\r\n\x1a\n" + bytes(range(256)) * 20)]:
            self.refuse(3, name, "replay", self.write(name, content))
        self.refuse(3, "other.h5", "replay", self.path("other.h5"))
        self.refuse(3, "missing.h5", "replay", self.path("missing.h5"))
        run_file, _ = self.small_run()
        with open(run_file, "rb") as f:
            half = f.read()[:20000]
        self.refuse(3, "half.h5", "replay", self.write("half.h5", half))


if __name__ == "__main__":
    unittest.main()
