"""The rows of scenes and findings that no other test of this folder has, nor free_motion_test and fallback_test of
tests/cli: held parts, flights, many bodies, lead-ins cut by a cone, threads, meshes of other people.

VERISIM_LONG_TESTS=1: all pairs of meshes, a nut turned by two turns, and every number of sides and clearance.
"""
import itertools
import os
import unittest

import h5py
import numpy as np

import ruler
from scene_test import HERE, LONG, SceneTest

INTEGRATORS = ("semi-implicit", "implicit")
SERIES = 300 * 400 / (300 + 400)  # N/m, of hand and coupling
PEGS = os.path.join(os.environ["VERISIM_SHARED_DATA"], "models", "factory_pegs")
THREAD = {"bolt": os.path.join(PEGS, "factory_bolt_m16_loose.obj"),
          "nut": os.path.join(PEGS, "factory_nut_m16_loose_subdiv_3x.obj")}
HAND_MAX = 35  # N
with_models = unittest.skipUnless(os.path.isdir(PEGS), f"no models of other people at {PEGS}: neither thread nor peg was tried")


class RunFileTest(SceneTest):
    def events(self, kind):
        with h5py.File(self.run_file) as f:
            return [e["text"].decode() for e in f["events"] if e["kind"] == kind.encode()]

    def by_voxels(self):
        """Contacts, and those that voxels answered, of the run's only pair."""
        with h5py.File(self.run_file) as f:
            return int(f["state/links/contacts"][:].sum()), int(f["state/links/by_voxels"][:].sum())


class TableTest(RunFileTest):
    def test_a_held_part_sags_by_its_weight_or_a_warning_says_that_it_has_none(self):
        for hybrid, integrator in itertools.product(("off", "exact"), INTEGRATORS):
            with self.subTest(hybrid=hybrid, integrator=integrator):
                pose = self.run_scene("held.lua", "b", dynamic="true", hybrid=hybrid, integrator=integrator).pose
                self.assertAlmostEqual(pose[-1, 2], -2000 * 0.03**3 * 9.81 / SERIES, delta=1e-8)
                self.assertEqual(self.events("gravity"), [])
                pose = self.run_scene("held.lua", "b", dynamic="false", hybrid=hybrid, integrator=integrator).pose
                self.assertEqual(np.abs(pose[:, :3]).max(), 0)
                self.assertEqual(len(self.events("gravity")), 1)

    def test_every_method_stops_a_ball_at_1_m_s_and_restore_what_off_stops(self):
        for integrator, v, z in itertools.product(INTEGRATORS, (1, 5, 13),
                                                (0.03, 0.042, 0.05) if LONG else (0.03, 0.05)):
            stopped = {}
            for hybrid in ("off", "restore", "blend", "exact"):
                with self.subTest(hybrid=hybrid, integrator=integrator, v=v, z=z):
                    pose = self.run_scene("bullet.lua", "b", hybrid=hybrid, integrator=integrator, v=v, z=z).pose
                    stopped[hybrid] = pose[:, 2].min() > 0
                    if v == 1 or hybrid == "exact" or (hybrid == "restore" and stopped["off"]):
                        self.assertTrue(stopped[hybrid], "it passed the plate")

    def test_exact_stops_a_ball_at_100_m_s(self):
        pose = self.run_scene("bullet.lua", "b", hybrid="exact", integrator="implicit", v=100, z=0.05).pose
        self.assertGreater(pose[:, 2].min(), 0.0055 - 1e-6)  # it touches the plate

    def test_many_boxes_stand_with_their_weight(self):
        weight = 1000 * 0.03**3 * 9.81
        for n in (10, 36, 64):
            with self.subTest(n=n):
                for recorded in self.run_scene("many.lua", *("b{}".format(i + 1) for i in range(n)), n=n):
                    self.assertLessEqual(np.abs(recorded.force[-100:, 2] / weight - 1).max(), 1e-6)
                    self.assertLessEqual(abs(recorded.pose[-1, 2] - 0.015), 1e-9)
                    self.assertLessEqual(np.linalg.norm(recorded.pose[:, :2] - recorded.pose[0, :2], axis=1).max(), 1e-9)
                with h5py.File(self.run_file) as f:
                    for name in ("rows_left_out", "contacts_left_out", "solver_unfinished"):
                        self.assertEqual(f["cost/" + name][:].sum(), 0, name)

    def test_a_press_is_what_its_springs_say_in_the_scenes_that_buzzed(self):
        for wall, hybrid, integrator in (("cone", "exact", "semi-implicit"), ("flat", "exact", "implicit"),
                                         ("flat", "restore", "semi-implicit"), ("flat", "restore", "implicit")):
            with self.subTest(wall=wall, hybrid=hybrid, integrator=integrator):
                pose, _, force = self.run_scene("press_buzz.lua", "tool", wall=wall, hybrid=hybrid, integrator=integrator)
                late = force[-1000:, 2]
                # A voxel's contact is a third spring in series: what the ball sinks in is missing from the 10 mm.
                sunk = 0.015 - pose[-1, 2] if wall == "flat" else 0
                self.assertAlmostEqual(late.mean(), SERIES * (0.01 - sunk), delta=1e-3)
                self.assertLessEqual(late.std(), 0.001 if hybrid == "exact" else 0.01 * late.mean())

    def test_blend_holds_a_box_on_its_plate(self):
        for integrator, voxelsize in itertools.product(INTEGRATORS, (0.002, 0.004)):
            with self.subTest(integrator=integrator, voxelsize=voxelsize):
                recorded = self.run_scene("resting.lua", "b", kind="box", hybrid="blend", integrator=integrator,
                                          voxelsize=voxelsize)
                weight = 1000 * 0.06 * 0.04 * 0.04 * 9.81
                self.assertLessEqual(abs(recorded.force[1000:, 2].mean() - weight), 1e-3 * weight)
                self.assertGreater(recorded.pose[:, 2].min(), 0.02 - voxelsize)

    def test_a_ball_rests_in_a_cone(self):
        pose, _, force = self.run_scene("resting_kinds.lua", "b", kind="spherecone", hybrid="exact", integrator="implicit", h0=0)
        weight = 1000 * 4 / 3 * np.pi * 0.03**3 * 9.81
        late = force[1000:]
        self.assertLessEqual(abs(late[:, 2].mean() - weight), 1e-3 * weight)
        self.assertGreater(pose[:, 2].min(), 0.03 * np.sqrt(2) - 0.05 - 1e-6)

    def test_prisms_whose_lead_in_is_a_cone_fit_into_their_holes(self):
        for n, c in itertools.product(range(3, 13), (5e-6, 2e-5, 1e-4)) if LONG else ((8, 2e-5),):
            with self.subTest(n=n, c=c):
                of_pin = self.largest_force(self.run_scene("prism_entry.lua", "peg", n=0, c=c))
                recorded = self.run_scene("prism_entry.lua", "peg", n=n, c=c, chamfer_by="cone")
                pose = recorded.pose[::20]  # the lead-in's edges are a thousand points
                overlap = ruler.overlap_of_prism_and_hole(pose, n, c, "cone")
                inside = pose[:, 2] < 0.043
                self.assertTrue(inside[-1], "it goes in")
                # Nine sides are wedged at 5 um, 15 N on 0.8 mm of edges of exactStiffness: 0.0250 c.
                self.assertLessEqual(overlap[inside].max(), (0.0255 if (n, c) == (9, 5e-6) else 0.02) * c)
                self.assertLessEqual(overlap.max(), 1e-6)
                self.assertLessEqual(self.largest_force(recorded), 2 * of_pin)


@with_models
class Models(RunFileTest):
    def check_thread(self, faces_recovered, **settings):
        """Voxels answer, an event says so, and no force is beyond the hand's."""
        nut = self.run_scene("nut.lua", "nut", brep="true" if faces_recovered else "false", **THREAD, **settings)
        contacts, by_voxels = self.by_voxels()
        self.assertGreater(by_voxels, 0.5 * contacts)
        if settings["hybrid"] != "off":
            (said,) = self.events("voxels")
            self.assertIn(f"voxels answered {by_voxels} of {contacts} contacts", said)
            self.assertIn("recovery declined" if faces_recovered else "of bare triangles", said)
        self.assertLessEqual(self.largest_force(nut), HAND_MAX)
        return nut

    def test_a_nut_is_not_pulled_off_its_thread(self):
        for hybrid, voxelsize in itertools.product(("off", "restore", "exact"), (0.0005, 0.001)):
            with self.subTest(hybrid=hybrid, voxelsize=voxelsize):
                nut = self.check_thread(False, hybrid=hybrid, integrator="implicit", voxelsize=voxelsize)
                self.assertLess(nut.pose[:, 2].max(), 1e-4)
                # Hand and coupling of 2000 N/m each, 20 mm away from the nut, that gives way by micrometres.
                self.assertAlmostEqual(self.largest_force(nut), 20, delta=0.1)

    def test_a_nut_is_screwed_off_one_way_and_stays_the_other_way(self):
        for sign, low, high in ((1, 0.0005, 0.0011), (-1, -2e-4, 2e-4)):
            with self.subTest(sign=sign):
                nut = self.check_thread(False, hybrid="exact", integrator="implicit", voxelsize=0.0005, turns=0.5, sign=sign)
                self.assertTrue(low < nut.pose[-1, 2] < high, nut.pose[-1, 2])

    def test_the_weak_contacts_of_a_semi_implicit_step_push_no_harder_than_the_hand(self):
        # They give way at 2.6 N, what the stability rule allows to 1e4 N/m: the nut comes off.
        self.check_thread(False, hybrid="off", integrator="semi-implicit", voxelsize=0.0005)

    @unittest.skipUnless(LONG, "a minute")
    def test_a_nut_whose_flat_faces_are_known_is_not_pulled_off(self):
        nut = self.check_thread(True, hybrid="exact", integrator="implicit", voxelsize=0.0004)
        self.assertLess(nut.pose[:, 2].max(), 1e-4)

    # By less than half a turn: beyond, the coupling turns the nut the other way, and says so. As the models have them, the
    # threads overlap by 0.7 mm where they begin (`replay --measure`): voxels of 0.5 mm tell of that.
    @unittest.skipUnless(LONG, "two minutes")
    def test_a_nut_whose_flat_faces_are_known_stays_when_it_is_turned_the_wrong_way(self):
        nut = self.check_thread(True, hybrid="exact", integrator="implicit", voxelsize=0.00025, turns=0.42, sign=-1)
        self.assertLess(np.abs(nut.pose[:, 2]).max(), 1e-3)
        self.assertEqual(self.events("coupling"), [])
        self.run_scene("nut.lua", "nut", brep="true", **THREAD, hybrid="exact", integrator="implicit", voxelsize=0.0005, turns=0.42,
                       sign=-1)
        self.assertIn("were put inside", self.events("overlap")[0])

    def test_pairs_of_meshes_go_in_exactly_or_say_that_they_are_not_exact(self):
        holes = {"round": ("round_hole_8mm_subdiv_3x", "round_peg_8mm_loose round_peg_8mm_tight"),
                 "wide": ("round_hole_16mm_subdiv_3x", "round_peg_16mm_loose"),
                 "rectangular": ("rectangular_hole_8mm_subdiv_3x",
                                 "rectangular_peg_8mm_loose_subdiv_3x rectangular_peg_8mm_tight_subdiv_3x")}
        pairs = [(hole, peg) for hole, pegs in holes.values() for peg in pegs.split()]
        for hole, peg in pairs if LONG else [p for p in pairs if "tight" in p[1]]:
            with self.subTest(hole=hole, peg=peg):
                files = [os.path.join(PEGS, "factory_" + name + ".obj") for name in (hole, peg)]
                self.run_scene("assembly.lua", folder=os.path.join(HERE, "..", "..", "scenarios"), model=",".join(files),
                               part="2", way="in", hybrid="exact")
                contacts, by_voxels = self.by_voxels()
                self.assertGreater(contacts, 0)
                (said,) = self.events("voxels")
                self.assertIn(f"voxels answered {by_voxels} of {contacts} contacts", said)
                if by_voxels == 0:
                    if "round" in peg:  # nothing leads a tight rectangular peg in that is turned about its axis
                        self.assertEqual(self.events("outcome")[-1], "assembled")
                    with h5py.File(self.run_file) as f:
                        self.assertLessEqual(f["state/links/max_penetration"][:].max(), 1e-7)
                    if LONG:  # minutes: a thousand facets
                        self.assertLessEqual(self.true_overlap("surfaces"), 1e-6)


if __name__ == "__main__":
    unittest.main()
