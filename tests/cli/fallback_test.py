"""No silent fallback: which share of its contacts voxels answered, and why, stands in the summary and in /events of
every pair under a hybrid method; counted here from the run file's rows. What cannot act as it was asked for is a
warning."""
import json
import os
import unittest

import h5py
import numpy

from program import ProgramTest, SHARED, SOURCE, turned_stl

PEGS = os.path.join(SHARED, "models", "factory_pegs")

# A rod is pushed through a bush that knows its faces or not, and against its wall; a tray is near, never touched.
BUSH = """
local p = params{ brep = true, hybrid = "exact", off = false, contact = "voxmap", rod = "" }
defineSimulationParameters{ hybrid = p.hybrid, contact = p.contact, duration = 0.6 }
addObject{ name = "bush", fixed = true, voxelsize = mm(1), Model{ "bush.stl", scale = 0.001, brep = p.brep } }
addObject{ name = "tray", fixed = true, voxelsize = mm(1), position = {0, 0, -0.041}, Solid.box{0.04, 0.04, 0.004} }
local rod = addObject{ name = "rod", voxelsize = mm(1), position = {0, 0, 0.041}, density = 1000,
                       hybrid = p.rod ~= "" and p.rod or p.hybrid, Solid.cylinder{radius = 0.0098, height = 0.06} }
local hand = Devices.Hand{ name = "hand", path = {
  {position = {0, 0, 0.041}}, {position = {0, 0, 0.02}, speed = 0.1}, {position = {0.001, 0, 0.02}, speed = 0.02} } }
addDevice(hand)
grasp(hand, rod)
if p.off then rod:setHybridEnabled(false) end
"""


class Fallback(ProgramTest):
    def run_bush(self, *options):
        self.write("bush.stl", turned_stl(inner=10, outer=16, height=20))
        run_file = self.path("bush.h5")
        done = self.succeed("run", self.write("bush.lua", BUSH), "-o", run_file, "--json", *options)
        self.assertEqual(done.stdout.count("\n"), 1)
        self.succeed("replay", run_file, "--verify")
        return run_file, json.loads(done.stdout), done.stderr

    def counted(self, run_file):
        """Pair -> contacts, contacts by voxels; frames with contact, frames with contact by voxels."""
        with h5py.File(run_file) as f:
            links = f["state/links"]
            pair, frame = links["pair"][()], links["frame"][()]
            contacts, by_voxels = links["contacts"][()], links["by_voxels"][()]
            names = [(p["first"].decode(), p["second"].decode()) for p in f["state/pairs"]]
            events = [e["text"].decode() for e in f["events"] if e["kind"] == b"voxels"]
        counts = {name: (int(contacts[pair == i].sum()), int(by_voxels[pair == i].sum()))
                  for i, name in enumerate(names)}
        frames = tuple(len(numpy.unique(frame[count > 0])) for count in (contacts, by_voxels))
        return {name: count for name, count in counts.items() if count[0] > 0}, frames, events

    def assert_told(self, run_file, summary, **why):
        """The summary and the events say what the rows say. Returns the pairs."""
        counts, _, events = self.counted(run_file)
        self.assertEqual({(p["first"], p["second"]): (p["contacts"], p["by_voxels"]) for p in summary["pairs"]}, counts)
        self.assertEqual(summary["by_voxels"], sum(by_voxels for _, by_voxels in counts.values()))
        self.assertEqual(len(events), len(counts))
        for p, event in zip(summary["pairs"], events):
            self.assertEqual(p["fraction"], p["by_voxels"] / p["contacts"])
            self.assertTrue(event.startswith(f"voxels answered {p['by_voxels']} of {p['contacts']} contacts ("), event)
            self.assertIn(f"of '{p['first']}' and '{p['second']}' under {p['hybrid']}", event)
            self.assertEqual(p["by_voxels"] > 0, p["why"] != "")
        return summary["pairs"]

    def test_exact_with_all_faces_known_has_none(self):
        run_file, summary, said = self.run_bush()
        (pair,) = self.assert_told(run_file, summary)
        self.assertEqual((pair["first"], pair["second"], pair["fraction"], pair["why"]), ("bush", "rod", 0, ""))
        self.assertEqual(summary["exact_frames"], summary["collision_frames"])
        self.assertNotIn("was asked for", said)

    def test_exact_that_voxels_answer_ends_with_one_warning(self):
        run_file, summary, said = self.run_bush("--set", "brep=false")
        (pair,) = self.assert_told(run_file, summary)
        self.assertEqual(pair["fraction"], 1)
        self.assertIn("no b-rep: 'bush' is of bare triangles", pair["why"])
        _, frames, _ = self.counted(run_file)
        self.assertEqual((summary["exact_frames"], summary["exact_frames_by_voxels"]), frames)
        warnings = [line for line in said.splitlines() if "was asked for" in line]
        self.assertEqual(len(warnings), 1, said)
        self.assertIn("warning: hybrid = \"exact\" was asked for, and voxels answered in 100 %", warnings[0])
        self.assertIn(pair["why"], warnings[0])
        table = self.succeed("run", self.path("bush.lua"), "-o", self.path("table.h5"), "--set", "brep=false")
        self.assertEqual(table.stderr.count("was asked for"), 1)
        (row,) = [line for line in table.stdout.splitlines() if line.startswith("  by voxels ")]
        self.assertIn(f"100 % of {pair['contacts']} contacts of bush and rod, exact: {pair['why']}", row)
        quiet = self.succeed("run", self.path("bush.lua"), "-o", self.path("q.h5"), "--set", "brep=false", "--quiet")
        self.assertEqual((quiet.stdout, quiet.stderr), ("", ""))

    def test_restore_is_told_and_off_says_nothing(self):
        run_file, summary, said = self.run_bush("--set", "hybrid=restore")
        (pair,) = self.assert_told(run_file, summary)
        self.assertEqual((pair["fraction"], pair["why"]), (1, "'restore' acts on the voxels' contacts"))
        self.assertNotIn("was asked for", said)
        run_file, summary, said = self.run_bush("--set", "hybrid=off")
        self.assertGreater(summary["by_voxels"], 0)
        self.assertEqual((summary["pairs"], self.counted(run_file)[2]), ([], []))

    def test_triangles_and_a_body_that_is_off_are_told(self):
        for options, why in ((["--set", "contact=fcl"], 'contact = "fcl": triangles answered, as with hybrid = "off"'),
                             (["--set", "rod=off"], "'rod' has hybrid = \"off\"")):
            run_file, summary, said = self.run_bush(*options)
            (pair,) = self.assert_told(run_file, summary)
            self.assertEqual((pair["hybrid"], pair["fraction"], pair["why"]), ("off", 1, why))
            self.assertEqual((summary["exact_frames"], said.count("was asked for")), (0, 0))
            table = self.succeed("run", self.path("bush.lua"), "-o", self.path("table.h5"), *options).stdout
            self.assertIn(f"100 % of {pair['contacts']} contacts of bush and rod, off: {why}", table)

    def test_what_a_script_switches_off_is_told_and_warned_of(self):
        run_file, summary, said = self.run_bush("--set", "off=true")
        (pair,) = self.assert_told(run_file, summary)
        frames = summary["collision_frames"]
        self.assertEqual(pair["why"], f"switched off in {frames} of {frames} frames with contact")
        self.assertEqual((summary["exact_frames"], summary["exact_frames_by_voxels"]), (frames, frames))
        self.assertIn(f"voxels answered in 100 % of the frames with contact: {pair['why']}", said)

    def test_the_warning_begins_above_one_frame_in_a_hundred(self):
        """A block slides over a drawn plate to a stop that is a bare mesh of the same body: exact, then both."""
        self.write("stop.stl", turned_stl(inner=0, outer=10, height=20))
        scenario = self.write("slide.lua", """
            defineSimulationParameters{ hybrid = "exact", duration = 1 }
            addObject{ name = "plate", fixed = true, voxelsize = mm(1), Solid.box{0.1, 0.06, 0.01},
                       Transform{ position = {0.036, 0, 0.0151}, Model{ "stop.stl", scale = 0.001 } } }
            local block = addObject{ name = "block", voxelsize = mm(1), position = {-0.03, 0, 0.011}, density = 1000,
                                     Solid.box{0.02, 0.02, 0.012} }
            local hand = Devices.Hand{ name = "hand", path = { {position = {-0.03, 0, 0.0105}},
              {position = {-0.03, 0, 0.0105}, dwell = 0.1}, {position = {0.02, 0, 0.0105}, speed = 0.1} } }
            addDevice(hand)
            grasp(hand, block)""")

        def run(name, *options):
            done = self.succeed("run", scenario, "-o", self.path(name), "--json", *options)
            self.succeed("replay", self.path(name), "--verify")
            summary = json.loads(done.stdout)
            self.assert_told(self.path(name), summary)
            _, frames, _ = self.counted(self.path(name))
            self.assertEqual((summary["exact_frames"], summary["exact_frames_by_voxels"]), frames)
            return frames[1] / frames[0], done.stderr.count("was asked for")

        fraction, warnings = run("long.h5")
        self.assertGreater(fraction, 0.01)
        self.assertEqual(warnings, 1)
        with h5py.File(self.path("long.h5")) as f:
            frame, by_voxels = f["state/links/frame"][()], f["state/links/by_voxels"][()]
        first = int(frame[by_voxels > 0][0])
        fraction, warnings = run("short.h5", "--duration", f"{(first + 2) / 1000}")
        self.assertTrue(0 < fraction <= 0.01, fraction)
        self.assertEqual(warnings, 0)

    def test_an_event_that_is_missing_or_another_is_found(self):
        run_file, _, _ = self.run_bush("--set", "brep=false")
        with h5py.File(run_file, "r+") as f:
            events = f["events"][()]
            events["text"][-1] = events["text"][-1].replace(b"100 %", b"0 %")
            f["events"][()] = events
        self.refuse(1, ["event", "voxels answered"], "replay", run_file, "--verify")

    def test_a_run_that_a_script_ends_tells_what_it_came_to(self):
        script = BUSH + "Actions.addFrameAction(function() Actions.waitSeconds(0.55) error('that is enough') end)"
        self.write("bush.stl", turned_stl(inner=10, outer=16, height=20))
        run_file = self.path("it.h5")
        self.run_program("run", self.write("it.lua", script), "-o", run_file, "--set", "hybrid=restore")
        with h5py.File(run_file) as f:
            kinds = [e["kind"] for e in f["events"]]
        self.assertEqual(kinds.count(b"voxels"), 1)
        self.succeed("replay", run_file, "--verify")

    def test_very_many_pairs_are_in_the_json_and_few_in_the_table(self):
        count = 400
        script = """
            defineSimulationParameters{ allBodiesAreDynamic = true, gravity = {0, 0, -9.81}, duration = 0.06 }
            addObject{ name = "plate", fixed = true, voxelsize = 0.01, Solid.box{2, 2, 0.02} }
            for i = 0, COUNT - 1 do
              addObject{ name = string.format("box_with_a_rather_long_name_%d", i), density = 500, voxelsize = 0.01,
                         position = {0.09 * (i % 20) - 0.9, 0.09 * math.floor(i / 20) - 0.9, 0.045},
                         Solid.box{0.06, 0.06, 0.06} }
            end"""
        run_file = self.path("many.h5")
        scenario = self.write("many.lua", script.replace("COUNT", str(count)))
        summary = self.run_json("run", scenario, "-o", run_file)
        self.assertEqual(len(summary["pairs"]), count)
        self.assert_told(run_file, summary)
        with h5py.File(run_file) as f:
            self.assertEqual(json.loads(f["summary"].attrs["json"])["pairs"], summary["pairs"])
        self.succeed("replay", run_file, "--verify")
        table = self.succeed("run", scenario, "-o", run_file).stdout
        self.assertEqual(table.count("  by voxels "), 9)
        self.assertIn(f"and {count - 8} more pairs", table)


class Assembly(ProgramTest):
    @unittest.skipUnless(os.path.isdir(PEGS), f"no models of other people at {PEGS}: no mesh pair was assembled")
    def test_mesh_pairs_have_their_faces_recovered_unless_it_is_forbidden(self):
        files = [os.path.join(PEGS, f"factory_round_{f}.obj") for f in ("hole_8mm_subdiv_3x", "peg_8mm_tight")]
        words = ["run", os.path.join(SOURCE, "scenarios", "assembly.lua"), "--set", "model=" + ",".join(files),
                 "--set", "part=2", "--set", "way=in", "--set", "hybrid=exact", "--json"]
        done = self.succeed(*words, "-o", self.path("known.h5"))
        known = json.loads(done.stdout)
        self.assertEqual(known["outcome"], "assembled")
        self.assertLess(known["max_penetration_m"], 1e-7)
        self.assertEqual(known["pairs"][0]["fraction"], 0)
        self.assertNotIn("was asked for", done.stderr)
        done = self.succeed(*words, "-o", self.path("bare.h5"), "--set", "brep=false")
        self.assertEqual(json.loads(done.stdout)["pairs"][0]["fraction"], 1)
        self.assertIn("warning: 'factory_round_hole_8mm_subdiv_3x' and 'factory_round_peg_8mm_tight' have no b-rep",
                      done.stderr)
        self.assertEqual(done.stderr.count("was asked for"), 1)

    def test_off_recovers_nothing(self):
        self.write("bush.stl", turned_stl(inner=10, outer=16, height=20))
        self.write("rod.stl", turned_stl(inner=0, outer=9.8, height=60))
        words = ["run", os.path.join(SOURCE, "scenarios", "assembly.lua"), "--set", "model=bush.stl,rod.stl", "--set",
                 "scale=0.001", "--set", "part=rod", "--set", "voxelsize=mm(1)", "--duration", "0.1"]
        for hybrid, count in [("off", 0), ("restore", 2), ("exact", 2)]:
            done = self.succeed(*words, "--set", "hybrid=" + hybrid, "-o", self.path(hybrid + ".h5"))
            self.assertEqual(done.stderr.count("faces recovered from its triangles"), count, done.stderr)


class Weight(ProgramTest):
    def said(self, script):
        run_file = self.path("it.h5")
        done = self.succeed("run", self.write("it.lua", script), "-o", run_file)
        self.succeed("replay", run_file, "--verify")
        with h5py.File(run_file) as f:
            return done.stderr, [e["kind"].decode() for e in f["events"]]

    def test_gravity_that_acts_on_no_held_body_is_a_warning(self):
        script = """
            defineSimulationParameters{ gravity = {0, 0, -9.81}, allBodiesAreDynamic = DYNAMIC, duration = 0.1 }
            local b = addObject{ name = "b", density = 2000, voxelsize = 0.002, Solid.box{0.03, 0.03, 0.03} }
            local hand = Devices.Hand{ name = "hand", path = { {position = {0, 0, 0}, dwell = 3} } }
            addDevice(hand)
            grasp(hand, b)"""
        stderr, kinds = self.said(script.replace("DYNAMIC", "false"))
        self.assertEqual((stderr.count("warning: gravity (0, 0, -9.81)"), kinds.count("gravity")), (1, 1), stderr)
        self.assertIn("allBodiesAreDynamic = true", stderr)
        stderr, kinds = self.said(script.replace("DYNAMIC", "true"))
        self.assertEqual((stderr, kinds.count("gravity")), ("", 0))

    def test_a_part_that_is_too_heavy_for_its_contacts_is_a_warning(self):
        script = """
            defineSimulationParameters{ gravity = {0, 0, -9.81}, allBodiesAreDynamic = true, duration = 0.5,
                                        hybrid = "restore", contactStiffness = STIFFNESS }
            addObject{ name = "plate", fixed = true, voxelsize = 0.005, Solid.box{0.3, 0.3, 0.02} }
            addObject{ name = "block", density = 7800, voxelsize = 0.005, position = {0, 0, 0.045},
                       Solid.box{0.06, 0.06, 0.06} }"""
        stderr, kinds = self.said(script.replace("STIFFNESS", "5"))
        self.assertEqual(stderr.count("warning: 'block' weighs 16.5 N and sinks"), 1, stderr)
        self.assertEqual(kinds.count("sinking"), 1)
        self.assertIn("raise contactStiffness (now 5 N/m)", stderr)
        stderr, kinds = self.said(script.replace("STIFFNESS", "10000"))
        self.assertEqual((stderr, kinds.count("sinking")), ("", 0))


if __name__ == "__main__":
    unittest.main()
