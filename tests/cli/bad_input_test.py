"""Bad input ends in one line that says where, what and what to do, and in exit code 3 (issue list of the engine)."""
import os
import struct
import unittest

import h5py

from program import ProgramTest, SMALL, SOURCE


def scene(body):
    return f'addObject{{ name = "it", voxelsize = 0.01, {body} }}'


TRACE = """# verisim-trace 1
# kind: haptic
# rate_hz: 1000
# source: made by hand
t,px,py,pz,qx,qy,qz,qw
"""


class BadScenarios(ProgramTest):
    def refuse_script(self, words, script, *options):
        return self.refuse(3, words, "run", self.write("bad.lua", script), "-o", self.path("x.h5"), *options)

    def test_missing_file(self):
        self.refuse(3, "missing.lua", "run", self.path("missing.lua"))
        self.refuse_script(["bad.lua:1", "missing.step"], scene('Model "missing.step"'))

    def test_syntax_and_run_time_errors_say_file_and_line(self):
        self.refuse_script("bad.lua:2", "local x = 1\nlocal = 2")
        self.refuse_script("bad.lua:2", "\nlocal x = nil + 1")

    def test_unknown_parameters_suggest_the_nearest(self):
        self.refuse_script(["clerance", "did you mean 'clearance'", "tilt"], "params{clearance = 0.005, tilt = 0}",
                           "--set", "clerance=0.004")

    def test_parameters_of_another_type(self):
        self.refuse_script("clearance", "params{clearance = 0.005}", "--set", "clearance=wide")

    def test_nan_anywhere(self):
        nan = "0/0"
        box = "Solid.box{0.1, 0.1, 0.1}"
        self.refuse_script("bad.lua", scene(f"Solid.box{{0.1, 0.1, {nan}}}"))
        self.refuse_script("bad.lua", scene(f"position = {{{nan}, 0, 0}}, {box}"))
        self.refuse_script("density", scene(f"density = {nan}, {box}"))
        self.refuse_script("bad.lua", f"defineSimulationParameters{{timestep = {nan}}}")
        self.refuse_script("bad.lua", f"defineSimulationParameters{{maxStiffness = {nan}}}")
        self.refuse_script("bad.lua", f"defineSimulationParameters{{gravity = {{0, 0, {nan}}}}}")

    def voxels_refused(self, words, size):
        script = SMALL.replace("voxelsize = 0.01", f"voxelsize = {size}")
        self.refuse_script(words, script)

    def test_voxel_sizes(self):
        for size in ["0", "-0.001", "1/0"]:
            self.voxels_refused("voxelsize", size)
        self.voxels_refused(["voxelsize", "plate"], "10")
        self.voxels_refused("m", "1e-7")  # would not fit into memory: the size that does is named

    def test_masses_at_the_extremes_run(self):
        for density in ["1e-9/(0.06*0.06*0.04)", "1e9/(0.06*0.06*0.04)"]:
            for integrator in ["semi-implicit", "implicit"]:
                script = SMALL.replace('name = "box",', f'name = "box", density = {density},').replace(
                    "duration = p.duration", f'duration = p.duration, integrator = "{integrator}"')
                summary = self.small_run(script=script)[1]
                self.assertEqual(summary["frames"], 300)

    def test_scripts_that_never_end_or_eat_memory(self):
        self.refuse_script("bad.lua", "while true do end")
        self.refuse_script("bad.lua", "while true do pcall(function() while true do end end) end")
        self.refuse_script("bad.lua", "local s = 'x' while true do s = s .. s end")

    def test_files_outside_the_folder(self):
        os.mkdir(self.path("inner"))
        self.write("secret.lua", "return 1")
        self.write("inner/bad.lua", 'dofile("../secret.lua")')
        self.refuse(3, "folder", "run", self.path("inner/bad.lua"))
        self.refuse_script("bad.lua", 'dofile("/etc/hostname")')
        self.refuse_script("bad.lua", 'io.open("/etc/hostname")')
        self.refuse_script("bad.lua", 'os.execute("true")')

    def test_two_objects_of_one_name(self):
        box = "Solid.box{0.1, 0.1, 0.1}"
        self.refuse_script("'it'", scene(box) + "\n" + scene(box))


class BadParameters(ProgramTest):
    """Of the shipped scenarios: each names what it was given and what there is instead."""

    def refuse_parameter(self, words, name, *settings):
        options = [word for setting in settings for word in ("--set", setting)]
        scenario = os.path.join(SOURCE, "scenarios", name + ".lua")
        self.refuse(3, words, "run", scenario, "-o", self.path("x.h5"), *options)

    def test_methods_that_do_not_exist(self):
        for name in ("peg_in_hole", "iso_fit", "assembly", "pins", "seats", "slide", "stack"):
            self.refuse_parameter(["'foo'", "blend, exact, off, restore"], name, "hybrid=foo")

    def test_fits_and_sizes_outside_the_table(self):
        for fit in ("H7/zz9", "H7", "g6/H7", "H99/g6", "H7/g99", "C11/h6", "K7/h6", "H7/c11", "Js7/h6", "h7/g6"):
            self.refuse_parameter([f"fit is '{fit}'", "as in H7/g6"], "iso_fit", "fit=" + fit)
        for nominal in ("0", "-0.025", "0.0029", "0.1201"):
            self.refuse_parameter(["nominal is", "3 to 120 mm"], "iso_fit", "nominal=" + nominal)
        for nominal in ("0/0", "1/0", "thick"):
            self.refuse_parameter("nominal", "iso_fit", "nominal=" + nominal)
        self.refuse_parameter(["'huge'", "loosest, mid, tightest"], "iso_fit", "size=huge")

    def test_hands_and_leads_that_make_no_sense(self):
        for setting in ("chamfer=-0.001", "chamfer=0.02", "error=0/0", "error=1", "tilt=2", "tremor=-1",
                        "tremor=mm(0.11)", "speed=0", "duration=-1"):
            self.refuse_parameter(setting.split("=")[0], "iso_fit", setting)

    def test_clearances_and_leans_that_make_no_sense(self):
        for name in ("seats", "pins"):
            for clearance in ("-1", "-0.0001", "0.02"):
                self.refuse_parameter([f"clearance is {clearance}", "between 0 and"], name, "clearance=" + clearance)
        for lean in ("-3", "3"):
            self.refuse_parameter([f"lean is {lean}", "between -0.785"], "pins", "lean=" + lean)

    def test_kinds_that_do_not_exist(self):
        self.refuse_parameter(["'feet'", "hand, solid"], "declared", "by=feet")
        self.refuse_parameter(["'wedge'", "cone, ball, socket"], "seats", "kind=wedge")
        self.refuse_parameter(["'bent'", "fitting, angled, spaced, single"], "pins", "kind=bent")


class BadModels(ProgramTest):
    def refuse_model(self, words, name, content):
        self.refuse(3, [name, *([words] if isinstance(words, str) else words)], "inspect", self.write(name, content))

    def test_empty_truncated_and_garbage(self):
        garbage = bytes((i * 37 + i // 7) % 256 for i in range(5000))
        for name in ["a.step", "a.stl", "a.obj", "a.ply", "a.glb", "a.brep"]:
            self.refuse_model("", name, b"")
            self.refuse_model("", name, garbage)
        self.refuse_model("", "half.stl", b"\0" * 80 + struct.pack("<I", 1000) + b"\0" * 100)
        self.refuse_model("", "half.step", b"ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION(('x'),'2;1');\n")

    def test_a_file_that_is_not_there_says_in_which_folder(self):
        for name in ("nope.step", "./nope.step", "inner/nope.step"):
            folder = os.path.realpath(os.path.dirname(os.path.join(self.folder, name)))
            self.refuse(3, f"{name}: there is no such file in {folder}; check", "inspect", name)

    def test_voxels_of_no_size(self):
        name = self.write("box.stl", self.box_stl(0.1))
        for size in ("0", "-0", "-1", "nan", "inf"):
            self.refuse(3, "voxelsize is", "inspect", name, "--voxel", size)

    def test_unknown_formats(self):
        self.refuse_model("", "a.docx", b"x")

    def test_nan_in_a_mesh(self):
        triangle = struct.pack("<12fH", 0, 0, 1, 0, 0, 0, 1, 0, float("nan"), 0, 1, 0, 0)
        self.refuse_model("", "nan.stl", b"\0" * 80 + struct.pack("<I", 1) + triangle)

    def box_stl(self, size, flipped=False, missing=0):
        corners = [(x * size, y * size, z * size) for z in (0, 1) for y in (0, 1) for x in (0, 1)]
        quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
        triangles = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))][missing:]
        out = b"\0" * 80 + struct.pack("<I", len(triangles))
        for a, b, c in triangles:
            order = (a, c, b) if flipped else (a, b, c)
            out += struct.pack("<3f", 0, 0, 0) + b"".join(struct.pack("<3f", *corners[i]) for i in order) + b"\0\0"
        return out

    def test_an_open_mesh_is_shown_and_not_simulated(self):
        name = self.write("open.stl", self.box_stl(0.1, missing=1))
        self.assertFalse(self.run_json("inspect", name)["parts"][0]["watertight"])
        self.write("bad.lua", 'addObject{ name = "it", voxelsize = 0.01, Model "open.stl" }')
        self.refuse(3, ["'it'", "open"], "run", self.path("bad.lua"))

    def test_an_inside_out_mesh_is_turned_and_said_so(self):
        part = self.run_json("inspect", self.write("inside.stl", self.box_stl(0.1, flipped=True)))["parts"][0]
        self.assertTrue(part["watertight"])
        self.assertAlmostEqual(part["volume_m3"], 0.001, delta=1e-9)
        self.assertTrue(part["notes"])

    def test_millimetres_read_as_metres_are_questioned(self):
        done = self.succeed("inspect", self.write("wide.stl", self.box_stl(750)))
        self.assertIn("warning: ", done.stderr)
        self.assertIn("0.001", done.stderr)


class BadTraces(ProgramTest):
    def refuse_trace(self, words, content, name="t.csv"):
        self.refuse(3, words, "trace", "info", self.write(name, content))

    def test_rows(self):
        good = "0,0,0,0,0,0,0,1\n"
        self.refuse_trace("t.csv", "")
        self.refuse_trace("t.csv", bytes(range(256)) * 10)
        self.refuse_trace("t.csv", TRACE)
        self.refuse_trace(["t.csv:7", "backwards"], TRACE + "0.02,0,0,0,0,0,0,1\n0.01,0,0,0,0,0,0,1\n")
        self.refuse_trace("t.csv:7", TRACE + good + good)
        self.refuse_trace("t.csv:7", TRACE + good + "0.001,nan,0,0,0,0,0,1\n")
        self.refuse_trace("t.csv:7", TRACE + good + "0.001,0,0,0,0,0,0,0\n")
        self.refuse_trace("t.csv:7", TRACE + good + "0.001,0,0\n")
        self.refuse_trace("t.csv", TRACE.replace("haptic", "smell") + good)
        self.refuse_trace("t.csv", TRACE.replace(",qw", "") + "0,0,0,0,0,0,0\n")
        self.refuse_trace("t.csv", TRACE + good + "5,0,0,0,0,0,0,1\n")

    def test_hdf5(self):
        with h5py.File(self.path("t.h5"), "w") as f:
            f["t"] = [0.0, 1.0]
        self.refuse(3, "t.h5", "trace", "info", self.path("t.h5"))
        with open(self.path("t.h5"), "rb") as f:
            content = f.read()
        self.refuse_trace("cut.h5", content[: len(content) // 2], "cut.h5")

    def test_a_trace_of_another_kind_drives_no_device(self):
        self.write("wii.csv", "# verisim-trace 1\n# kind: wii\n# rate_hz: 100\n# source: x\n"
                   "t,battery,gx,gy,gz,x1,y1,s1,x2,y2,s2,x3,y3,s3,x4,y4,s4\n0,1,0,0,1" + ",-1" * 12 + "\n")
        self.write("bad.lua", 'addDevice(Devices.Replay{ name = "r", trace = "wii.csv" })')
        self.refuse(3, "wii", "run", self.path("bad.lua"))


if __name__ == "__main__":
    unittest.main()
