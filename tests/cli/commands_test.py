"""Commands, options and what they print (INTERFACES section 1)."""
import ctypes
import json
import os
import re
import resource
import subprocess
import unittest

import h5py

from program import turned_stl, ProgramTest, SMALL, SOURCE, VERISIM

def system_grants_priority():
    before = os.sched_getscheduler(0), os.sched_getparam(0)
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(1))
    except PermissionError:
        return False
    os.sched_setscheduler(0, *before)
    return True


def lose_the_right_to_priority():
    """In a child before it becomes another program: root's by the bounding set, a user's by the limit."""
    CAP_SYS_NICE, PR_CAPBSET_DROP = 23, 24
    resource.setrlimit(resource.RLIMIT_RTPRIO, (0, 0))
    ctypes.CDLL(None).prctl(PR_CAPBSET_DROP, CAP_SYS_NICE, 0, 0, 0)


COMMANDS = ["run", "batch", "replay", "recover", "inspect", "compare", "trace", "doctor"]


class Commands(ProgramTest):
    def test_each_explains_itself_with_an_example(self):
        for command in COMMANDS:
            text = self.succeed(command, "--help").stdout
            self.assertTrue("Example:" in text or command == "trace", command)
        self.assertIn("Example:", self.succeed("batch", "merge", "--help").stdout)
        for command in ["info", "convert", "synth"]:
            self.assertIn("Example:", self.succeed("trace", command, "--help").stdout)

    def test_examples_are_what_a_shell_takes_and_their_files_are_there(self):
        commands = [line.split()[0] for line in self.succeed("--help").stdout.split("Subcommands:")[1].splitlines() if line.startswith("  ")
                    and not line.startswith("   ")]
        self.assertIn("tradeoff", commands)
        for words in [[], *([command] for command in commands), ["batch", "merge"], *(["trace", kind] for kind in ("info", "convert", "synth"))]:
            text = self.succeed(*words, "--help").stdout
            self.assertIn("Example:", text, words)
            example = re.sub(r"(?m)^(Example:)? +(?=verisim )", "", text[text.index("Example:"):])
            for line in example.splitlines():
                if not line.startswith("verisim ") or line.startswith("verisim COMMAND"):
                    continue
                done = subprocess.run(["bash", "-n", "-c", line], capture_output=True, text=True)
                self.assertEqual((done.returncode, done.stderr), (0, ""), line)
                for file in re.findall(r"scenarios/[\w/.]+|\S+\.step\b", line):
                    self.assertTrue(os.path.exists(os.path.join(SOURCE, file)), line)

    def test_wrong_usage_is_exit_2(self):
        scenario = self.write("small.lua", SMALL)
        self.refuse(2, "--help")
        self.refuse(2, "--help", "fly")
        self.refuse(2, "--help", "run")
        self.refuse(2, "--help", "run", scenario, "--bogus")
        self.refuse(2, "NAME=VALUE", "run", scenario, "--set", "voxelsize")
        self.refuse(2, "--help", "run", scenario, "--duration", "-1")
        self.refuse(2, ["AVX9", "scalar"], "run", scenario, "--simd", "AVX9")

    def test_run_prints_the_promised_keys(self):
        run_file, summary = self.small_run()
        for key in ["scenario", "run_file", "frames", "simulated_s", "wall_s", "realtime_factor", "collision_frames",
                    "overruns", "cache_hits", "cache_misses", "constraints", "max_force_N", "max_penetration_m", "outcome",
                    "state_hash", "frame_ns", "collision_frame_ns", "load_s"]:
            self.assertIn(key, summary)
        self.assertEqual(summary["frames"], 300)
        self.assertEqual(summary["run_file"], run_file)
        self.assertRegex(summary["state_hash"], "^[0-9a-f]{16}$")
        self.assertEqual(sorted(summary["frame_ns"]), ["max", "p50", "p99"])
        self.assertGreater(summary["collision_frames"], 50)

    def test_quiet_says_nothing_and_a_pipe_sees_no_progress_bar(self):
        scenario = self.write("small.lua", SMALL)
        quiet = self.succeed("run", scenario, "-o", self.path("a.h5"), "--quiet")
        self.assertEqual((quiet.stdout, quiet.stderr), ("", ""))
        self.assertNotIn("\r", self.succeed("run", scenario, "-o", self.path("a.h5")).stderr)

    def test_a_closed_pipe_kills_nothing(self):
        scenario = self.write("small.lua", SMALL)
        shell = f'"{VERISIM}" run "{scenario}" -o "{self.path("a.h5")}" --json | true'
        self.assertEqual(subprocess.run(["bash", "-c", shell], cwd=self.folder).returncode, 0)
        with h5py.File(self.path("a.h5")) as f:
            self.assertEqual(len(f["/state/time"]), 300)

    def test_set_changes_parameters_and_a_bare_word_is_a_string(self):
        run_file, _ = self.small_run("--set", "voxelsize=mm(20)/2", "--set", "word=H7/g6")
        with h5py.File(run_file) as f:
            parameters = json.loads(f.attrs["parameters"])
        self.assertEqual(parameters["voxelsize"], 0.01)
        self.assertEqual(parameters["word"], "H7/g6")

    def test_duration_and_seed_win_over_the_script(self):
        run_file, summary = self.small_run("--duration", "0.05", "--seed", "7")
        self.assertEqual(summary["frames"], 50)
        with h5py.File(run_file) as f:
            self.assertEqual(f.attrs["seed"], 7)

    def test_seeds_simd_targets_and_threads_change_what_they_should(self):
        script = SMALL.replace('name = "hand",', 'name = "hand", tremor = 0.001,')
        hashes = [self.small_run(*options, script=script)[1]["state_hash"] for options in
                  [[], ["--threads", "2"], ["--simd", "scalar"], ["--seed", "5"]]]
        self.assertEqual(hashes[0], hashes[1])
        self.assertEqual(hashes[0], hashes[2])
        self.assertNotEqual(hashes[0], hashes[3])

    def test_realtime_takes_its_time(self):
        summary = self.small_run("--realtime", "--duration", "0.2")[1]
        self.assertGreater(summary["wall_s"], 0.19)
        self.assertAlmostEqual(summary["realtime_factor"], 1, delta=0.2)

    def test_realtime_asks_for_priority_and_says_when_it_is_refused(self):
        run_file, summary = self.small_run("--realtime", "--duration", "0.05")
        self.assertEqual(summary["realtime_priority"], system_grants_priority())
        self.assertFalse(self.small_run()[1]["realtime_priority"])
        command = [VERISIM, "run", self.path("small.lua"), "-o", run_file, "--realtime", "--duration", "0.05"]
        refused = subprocess.run(command, preexec_fn=lose_the_right_to_priority, capture_output=True, text=True)
        self.assertEqual(refused.returncode, 0, refused.stderr)
        self.assertIn("no real-time priority", refused.stderr)
        self.assertEqual(subprocess.run(command + ["--quiet"], preexec_fn=lose_the_right_to_priority,
                                        capture_output=True, text=True).stderr, "")

    def test_the_run_file_is_what_interfaces_says(self):
        run_file, summary = self.small_run()
        with h5py.File(run_file) as f:
            self.assertEqual(f.attrs["format"], "verisim-run")
            for key in ["format_version", "scenario", "scenario_sha256", "parameters", "seed", "dt", "version", "state_hash"]:
                self.assertIn(key, f.attrs)
            self.assertEqual(f.attrs["state_hash"], summary["state_hash"])
            n = summary["frames"]
            shapes = {"/state/time": (n,), "/state/body/box/pose": (n, 7), "/state/body/box/twist": (n, 6),
                      "/state/body/box/force": (n, 6), "/state/device/hand/handle_pose": (n, 7),
                      "/state/device/hand/raw_pose": (n, 7), "/state/device/hand/wrench": (n, 6),
                      "/state/hash": (n,), "/timing/frame_ns": (n,), "/timing/period_ns": (n,),
                      "/timing/overrun": (n,)}
            m = f["/cost/links"][()].sum()
            self.assertGreater(m, 0)
            for fact in ("frame", "pair", "contacts", "by_voxels", "cache_hits", "cache_misses", "constraint",
                         "alignment", "max_penetration", "wrench"):
                shapes["/state/links/" + fact] = (m, 6) if fact == "wrench" else (m,)
            self.assertEqual(f["/state/pairs"][()].tolist(), [(b"plate", b"box")])
            self.assertEqual(f["/state/pairs"].dtype.names, ("first", "second"))
            for path, shape in shapes.items():
                self.assertEqual(f[path].shape, shape, path)
            self.assertEqual(f["/state/time"][0], 0.001)
            self.assertEqual(format(f["/state/hash"][-1], "016x"), summary["state_hash"])

            def documented(name, item):
                if isinstance(item, h5py.Dataset) and not name.startswith("inputs"):
                    self.assertIn("description", item.attrs, name)
                    self.assertTrue("units" in item.attrs or name == "events", name)
            f.visititems(documented)
            self.assertEqual(f["/summary"].attrs["frames"], n)

    def test_doctor_lists_simd_targets(self):
        self.assertIn("scalar", json.loads(self.succeed("doctor", "--json").stdout)["simd"])

    def test_inspect_counts_voxels(self):
        stl = self.write("tetrahedron.stl", """solid t
facet normal 0 0 -1
outer loop
vertex 0 0 0
vertex 0 10 0
vertex 10 0 0
endloop
endfacet
facet normal 0 -1 0
outer loop
vertex 0 0 0
vertex 10 0 0
vertex 0 0 10
endloop
endfacet
facet normal -1 0 0
outer loop
vertex 0 0 0
vertex 0 0 10
vertex 0 10 0
endloop
endfacet
facet normal 1 1 1
outer loop
vertex 10 0 0
vertex 0 10 0
vertex 0 0 10
endloop
endfacet
endsolid t
""")
        report = self.run_json("inspect", stl, "--scale", "0.001", "--voxel", "0.0005")
        part = report["parts"][0]
        self.assertTrue(part["watertight"])
        self.assertAlmostEqual(part["volume_m3"], 1e-6 / 6, delta=1e-15)
        self.assertEqual(part["triangles"], 4)
        self.assertGreater(part["surface_voxels"], 300)
        self.assertGreater(part["memory_bytes"], 0)
        self.assertEqual(report["mates"], [])
        self.assertEqual(part["faces"]["plane"], 4)
        self.assertEqual(part["edges"]["line"], 6)
        self.assertGreater(part["feature_sets"], 10)  # faces, edges, and what meets at corners

    def test_inspect_recovers_faces_and_edges_from_triangles(self):
        stl = self.write("bush.stl", turned_stl(inner=10, outer=16, height=20))
        part = self.run_json("inspect", stl, "--scale", "0.001", "--voxel", "0.001")["parts"][0]
        self.assertEqual({k: n for k, n in part["faces"].items() if n}, {"plane": 2, "cylinder": 2})
        self.assertEqual({k: n for k, n in part["edges"].items() if n}, {"circle": 4})
        radii = sorted((c["radius_m"], c["hole"]) for c in part["cylinders"])
        self.assertAlmostEqual(radii[0][0], 0.010, delta=1e-8)
        self.assertAlmostEqual(radii[1][0], 0.016, delta=1e-8)
        self.assertEqual([hole for _, hole in radii], [True, False])
        self.assertGreaterEqual(part["feature_sets"], 8)


if __name__ == "__main__":
    unittest.main()
