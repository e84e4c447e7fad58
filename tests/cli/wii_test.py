"""The head trackers on the command line: track, validate, place (INTERFACES section 1)."""
import csv
import json
import math
import os
import unittest
import xml.etree.ElementTree

from program import SOURCE, ProgramTest

COLUMNS = "t,battery,gx,gy,gz,x1,y1,s1,x2,y2,s2,x3,y3,s3,x4,y4,s4"
SANITIZED = os.environ.get("VERISIM_SANITIZE", "") != ""  # ten times slower
AT_REST = "0.75,0,0,1,609,384,4,415,384,4,-1,-1,-1,-1,-1,-1"


def trace(header="", rows=20):
    lines = ["# verisim-trace 1", "# kind: wii", "# rate_hz: 100", "# source: a test"]
    lines += header.splitlines() + [COLUMNS]
    return "\n".join(lines + [f"{0.01 * i:.2f},{AT_REST}" for i in range(rows)]) + "\n"


class Track(ProgramTest):
    def track(self, *args):
        self.succeed("wii", "track", *args, "-o", self.path("pose.csv"))
        with open(self.path("pose.csv")) as f:
            return list(csv.DictReader(f))

    def test_writes_one_row_per_sample_with_variances(self):
        rows = self.track(self.write("head.csv", trace()), "--tracker", "geometric")
        self.assertEqual(list(rows[0]), "t,valid,px,py,pz,qx,qy,qz,qw,cpx,cpy,cpz,crx,cry,crz".split(","))
        self.assertEqual([r["valid"] for r in rows], ["1"] * 20)
        # 194 pixels between LEDs 0.15 m apart: 512 / tan(21.5 deg) * 0.15 / 194.
        self.assertAlmostEqual(float(rows[9]["pz"]), 512 / math.tan(math.radians(21.5)) * 0.15 / 194, places=12)
        self.assertGreater(float(rows[9]["cry"]), 0.01, "two LEDs cannot know yaw, and must say so")

    def test_takes_leds_and_field_of_view_from_the_trace(self):
        head = self.write("head.csv", trace("# leds: 0.1 0 0; -0.1 0 0\n# fov_deg: 33 23"))
        z = float(self.track(head)[0]["pz"])
        self.assertAlmostEqual(z, 512 / math.tan(math.radians(16.5)) * 0.2 / 194, places=12)

    def test_stereo_takes_two_placed_traces(self):
        first = self.write("a.csv", trace("# remote_pose: 0 0 0 0 0 0 1"))
        second = self.write("b.csv", trace("# remote_pose: 0 0.01 0 0 0 0 1"))
        rows = self.track(first, "--second", second, "--tracker", "stereo")
        self.assertEqual(len(rows), 20)
        unplaced = self.write("c.csv", trace())
        self.refuse(3, ["c.csv", "remote_pose"], "wii", "track", first, "--second", unplaced, "--tracker", "stereo", "-o",
                    self.path("x.csv"))
        self.refuse(2, "--second", "wii", "track", first, "--tracker", "stereo", "-o", self.path("x.csv"))

    def test_refuses_what_it_cannot_use(self):
        head = self.write("head.csv", trace())
        out = ["-o", self.path("x.csv")]
        self.refuse(3, ["three-led", "needs three"], "wii", "track", head, "--tracker", "three-led", *out)
        self.refuse(2, "geometrik", "wii", "track", head, "--tracker", "geometrik", *out)
        self.refuse(3, "nowhere.csv", "wii", "track", "nowhere.csv", *out)
        self.refuse(3, ["leds", "3"], "wii", "track", self.write("l.csv", trace("# leds: 0.1 0; 0 0 0")), *out)
        self.refuse(3, "fov_deg", "wii", "track", self.write("f.csv", trace("# fov_deg: wide")), *out)
        self.refuse(5, "cannot be written", "wii", "track", head, "-o", self.path("no/x.csv"))


class Validate(ProgramTest):
    @unittest.skipIf(SANITIZED, "of all trajectories; the tests of one below run the same code")
    def test_prints_every_tracker_and_trajectory(self):
        text = self.succeed("wii", "validate", "--sensor", "ideal").stdout
        for word in ["geometric", "vrpn-compatible", "three-led", "scaat", "stereo", "natural-yaw", "dropout-both"]:
            self.assertIn(word, text)

    @unittest.skipIf(SANITIZED, "of all trajectories; the tests of one below run the same code")
    def test_the_readme_shows_what_is_printed(self):
        table = self.succeed("wii", "validate", "--sensor", "ideal", "--markdown").stdout
        with open(os.path.join(SOURCE, "README.md")) as readme:
            self.assertIn(table, readme.read(), "verisim wii validate --sensor ideal --markdown")
        self.assertEqual(len(table.splitlines()), 2 + 14)

    @unittest.skipIf(SANITIZED, "of all trajectories; the tests of one below run the same code")
    def test_the_readmes_picture_is_what_is_drawn(self):
        self.succeed("wii", "validate", "-o", self.path("validation.csv"))
        with open(self.path("validation.svg")) as here, open(os.path.join(SOURCE, "engine/wii/validation.svg")) as shipped:
            self.assertEqual(here.read(), shipped.read(), "verisim wii validate -o engine/wii/validation.csv")
        with open(self.path("validation.csv")) as f:
            rows = list(csv.DictReader(f))
        self.assertEqual(len(rows), 14 * 6 * 2)
        for row in rows:
            self.assertLessEqual(float(row["nees_lower"]), float(row["nees_upper"]))

    def test_a_table_of_one_trajectory_has_all_trackers(self):
        args = ["wii", "validate", "--trajectory", "natural", "--sensor", "ideal"]
        table, text = self.succeed(*args, "--markdown").stdout, self.succeed(*args).stdout
        self.assertEqual(len(table.splitlines()), 2 + 1)
        for tracker in ["geometric", "vrpn-compatible", "three-led", "scaat", "stereo"]:
            self.assertIn(tracker, table)
            self.assertIn(tracker, text)

    def test_plots_errors_over_time_of_trajectories_that_are_named(self):
        self.succeed("wii", "validate", "--trajectory", "dropout-both", "--tracker", "scaat", "-o", self.path("a.csv"))
        for sensor in ["ideal", "wiimote"]:
            plot = xml.etree.ElementTree.parse(self.path(f"a-dropout-both-{sensor}.svg")).getroot()
            words = [t.text for t in plot.iter("{http://www.w3.org/2000/svg}text")]
            self.assertIn("scaat", words)
            paths = [p.get("d") for p in plot.iter("{http://www.w3.org/2000/svg}path")]
            self.assertEqual(max(d.count("M") for d in paths), 11, "a line interrupted by ten dropouts")

    def test_a_recorded_motion_is_a_trajectory(self):
        lines = ["# verisim-trace 1", "# kind: haptic", "# rate_hz: 60", "# source: a test", "t,px,py,pz,qx,qy,qz,qw"]
        for i in range(300):
            s = math.sin(i / 60)
            lines.append(f"{5 + i / 60},{0.1 * s},{0.05 * s},{1 + 0.2 * s},0,0,{math.sin(0.1 * s)},{math.cos(0.1 * s)}")
        motion = self.write("nod.csv", "\n".join(lines) + "\n")
        rows = self.run_json("wii", "validate", "--motion", motion, "--sensor", "ideal")["rows"]
        self.assertEqual({row["trajectory"] for row in rows}, {"nod"})
        self.assertEqual({row["tracker"] for row in rows} & {"vrpn-compatible", "scaat"}, {"vrpn-compatible", "scaat"})
        for row in rows:
            self.assertEqual(row["reports"], 498)
            if row["tracker"] != "vrpn-compatible":
                self.assertLess(row["position_m"]["rms"], 0.005, row["tracker"])
        self.refuse(3, "px", "wii", "validate", "--motion", self.write("w.csv", trace()))

    def test_figures_are_the_same_in_every_run_but_for_the_time(self):
        def figures():
            args = ["wii", "validate", "--trajectory", "natural", "--sensor", "wiimote", "--json"]
            rows = json.loads(self.succeed(*args).stdout)["rows"]
            return [{k: v for k, v in r.items() if k != "update_ns"} for r in rows]

        self.assertEqual(figures(), figures())

    def test_refuses_unknown_names(self):
        self.refuse(2, "natrual", "wii", "validate", "--trajectory", "natrual")


class Place(ProgramTest):
    def test_count_agrees_with_the_corrected_equation(self):
        report = self.run_json("wii", "place", "--count", "100")
        c = report["coverage"]
        self.assertLess(abs(c["volume_counted_m3"] - c["volume_m3"]), 4 * c["volume_standard_error_m3"])
        self.assertGreater(abs(c["volume_counted_m3"] - c["volume_as_printed_m3"]), 4 * c["volume_standard_error_m3"])
        self.assertGreater(report["covered"], 0.9)

    def test_a_place_of_the_users_own(self):
        # Of the help's example: behind the screen, beside it, below it.
        words = ["wii", "place", "--head", "0", "1.2", "1", "--screen", "0", "1.2", "0", "--samples", "1000"]
        behind = self.run_json(*words, "--at", "0", "1.2", "-0.2", "0", "0")
        self.assertEqual(behind["covered"], 0)
        self.assertIsNone(behind["expected_error_m"])
        self.assertGreater(len(behind["lost"]["hidden"]), 900)
        self.assertEqual(sum(len(heads) for heads in behind["lost"].values()), 1000)
        through = self.run_json(*words, "--at", "0", "1.2", "-0.2", "0", "0", "--screen-size", "0", "0")
        below = self.run_json(*words, "--at", "0", "0.9", "0.05", "0", "15")
        for place in through, below:
            self.assertGreater(place["covered"], 0.5)
            self.assertEqual(len(sum(place["lost"].values(), [])), round(1000 * (1 - place["covered"])))
        boxed = self.run_json(*words, "--at", "0", "0.9", "0.05", "0", "15", "--obstacle", "-1", "0.8", "0.3", "1", "2", "0.4")
        self.assertEqual(boxed["covered"], 0)
        self.refuse(2, "lower", *words, "--obstacle", "1", "1", "1", "0", "0", "0")
        self.refuse(2, "--at", *words, "--at", "0", "0.9", "nan", "0", "15")

    def test_no_option_is_ignored(self):
        self.succeed("trace", "synth", "wii", "--trajectory", "static", "-o", self.path("heads.csv"))
        for option in ["--head", "0", "0", "1"], ["--spread", "0", "0", "1"], ["--count", "3"], ["--screen-size", "1", "1"]:
            self.refuse(2, option[0], "wii", "place", "--heads", self.path("heads.csv"), *option)
        for option in ["--room-min", "0", "0", "0"], ["--room-max", "0", "0", "0"]:
            self.refuse(2, option[0], "wii", "place", "--at", "0", "0", "0", "0", "0", *option)

    @unittest.skipIf(SANITIZED, "place_test runs the same code")
    def test_places_are_a_list_by_coverage_and_error(self):
        words = ["wii", "place", "--head", "0", "1.2", "1", "--screen", "0", "1.2", "0", "--room-min", "-0.6", "0.7", "-0.3",
                 "--room-max", "0.6", "1.7", "0", "--count", "200", "--samples", "1000"]
        places = self.run_json(*words)["places"]
        self.assertGreater(len(places), 2)
        for a, b in zip(places, places[1:]):
            self.assertGreater(a["expected_error_m"], b["expected_error_m"])
        text = self.succeed(*words).stdout
        self.assertEqual(text.splitlines()[0].split(), "x m y m z m heading pitch seen % error cm".split())


if __name__ == "__main__":
    unittest.main()
