"""Prepared parts on disk: a run has the same bits without them, with them, cold, warm, and when they were damaged."""
import glob
import os
import random
import subprocess
import unittest

import h5py

from program import SOURCE, VERISIM, ProgramTest

SCENES = {"peg_in_hole.lua": ["--set", "hybrid=restore"], "iso_fit.lua": ["--set", "hybrid=exact"],
          "peg_in_hole_step.lua": [], "declared.lua": []}


def content_of(path):
    """Everything of a run file but what the wall clock wrote."""
    found = {}
    with h5py.File(path, "r") as f:
        def take(name, item):
            if name.split("/")[0] in ("timing", "summary"):
                return
            found[name] = item[()].tobytes() if isinstance(item, h5py.Dataset) and item.dtype.kind != "O" else str(
                [list(map(str, e)) for e in item[()]] if isinstance(item, h5py.Dataset) and item.dtype.names else item)
            found[name + " attributes"] = sorted((key, str(value)) for key, value in item.attrs.items())
        f.visititems(take)
        found["state_hash"] = f.attrs["state_hash"]
    return found


class Cache(ProgramTest):
    def setUp(self):
        super().setUp()
        self.cache = self.path("cache")
        self.environment = {**os.environ, "VERISIM_CACHE": self.cache}

    def entries(self):
        return sorted(glob.glob(os.path.join(self.cache, "*.prepared*")))

    def run_scene(self, scene, *options, **more):
        out = self.path("run.h5")
        done = self.run_program("run", os.path.join(SOURCE, "scenarios", scene), "-o", out, "--force", "--duration", "0.5",
                                *options, env=more.get("env", self.environment))
        self.assertEqual(done.returncode, 0, done.stderr)
        return content_of(out), done.stderr

    def test_the_same_bits_without_cold_and_warm(self):
        for scene, options in SCENES.items():
            with self.subTest(scene):
                without, _ = self.run_scene(scene, *options, "--no-cache")
                before = self.entries()
                cold, said = self.run_scene(scene, *options)
                self.assertGreater(len(self.entries()), len(before))
                self.assertNotIn("damaged", said)
                warm, _ = self.run_scene(scene, *options)
                self.assertEqual(cold, without)
                self.assertEqual(warm, without)

    def test_a_warm_run_asks_no_cad_kernel(self):
        self.run_scene("peg_in_hole.lua")
        written = {path: os.stat(path).st_ino for path in self.entries()}
        strace = subprocess.run(["sh", "-c", "command -v strace"], capture_output=True).stdout.strip()
        self.run_scene("peg_in_hole.lua")
        self.assertEqual({path: os.stat(path).st_ino for path in self.entries()}, written, "nothing was made anew")
        if strace:
            done = subprocess.run([strace, "-f", "-e", "trace=execve", VERISIM, "run",
                                   os.path.join(SOURCE, "scenarios", "peg_in_hole.lua"), "-o", self.path("s.h5"), "--duration",
                                   "0.01", "--quiet"], capture_output=True, text=True, env=self.environment)
            self.assertNotIn("verisim-cad", done.stderr)

    def test_what_was_tampered_with_is_made_anew_and_said(self):
        right, _ = self.run_scene("iso_fit.lua", "--set", "hybrid=exact")
        draw = random.Random(1)
        entries = self.entries()
        for kind in ("parts", "voxels", "exact-body"):
            self.assertTrue(any(os.path.basename(path).startswith(kind) for path in entries), kind)
        for path in entries:
            with open(path, "rb") as f:
                content = bytearray(f.read())
            content[draw.randrange(len(content))] ^= 1 << draw.randrange(8)
            with open(path, "wb") as f:
                f.write(content)
        again, said = self.run_scene("iso_fit.lua", "--set", "hybrid=exact")
        self.assertEqual(again, right)
        self.assertIn(f"{len(entries)} prepared part(s) in {self.cache} were damaged and have been made anew", said)
        self.assertEqual(self.run_scene("iso_fit.lua", "--set", "hybrid=exact")[1].count("damaged"), 0)

    def test_another_build_prepares_anew(self):
        right, _ = self.run_scene("iso_fit.lua")
        entries = self.entries()
        os.mkdir(self.path("other"))
        for name in ("verisim", "verisim-cad"):
            with open(os.path.join(os.path.dirname(VERISIM), name), "rb") as f:
                program = bytearray(f.read())
            note = program.index(b"\x14\0\0\0\x03\0\0\0GNU\0")  # 20 bytes of build id
            if name == "verisim-cad":
                program[note + 16] ^= 1
            with open(self.path("other/" + name), "wb") as f:
                f.write(program)
            os.chmod(self.path("other/" + name), 0o755)
        done = subprocess.run([self.path("other/verisim"), "run", os.path.join(SOURCE, "scenarios", "iso_fit.lua"), "-o",
                               self.path("run.h5"), "--force", "--duration", "0.5"], env=self.environment, capture_output=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(len(self.entries()), 2 * len(entries))
        self.assertEqual(content_of(self.path("run.h5")), right)

    def test_no_cache_neither_reads_nor_writes(self):
        self.run_scene("iso_fit.lua", "--no-cache")
        self.assertEqual(self.entries(), [])

    def test_a_folder_that_cannot_be_written_is_no_obstacle(self):
        right, _ = self.run_scene("iso_fit.lua", "--no-cache")
        for folder in ("/proc/none", self.write("file", "")):
            self.assertEqual(self.run_scene("iso_fit.lua", env={**os.environ, "VERISIM_CACHE": folder})[0], right)
        homeless = {key: value for key, value in os.environ.items() if key not in ("HOME", "VERISIM_CACHE", "XDG_CACHE_HOME")}
        self.assertEqual(self.run_scene("iso_fit.lua", env=homeless)[0], right)

    def test_a_batch_prepares_once_and_says_what_was_damaged(self):
        def index(folder, *options):
            done = self.run_program("batch", os.path.join(SOURCE, "scenarios", "peg_in_hole.lua"), "--vary", "clearance=1mm,5mm",
                                    "--repeat", "2", "--duration", "0.2", "-o", self.path(folder), *options, env=self.environment)
            self.assertEqual(done.returncode, 0, done.stderr)
            with open(self.path(folder + "/index.csv"), "rb") as f:
                return f.read(), done.stderr
        cold, _ = index("cold")
        entries = self.entries()
        warm, said = index("warm")
        self.assertEqual(self.entries(), entries)
        self.assertNotIn("damaged", said)
        without, _ = index("without", "--no-cache")
        for path in entries:
            with open(path, "ab") as f:
                f.write(b"x")
        damaged, said = index("damaged")
        self.assertIn("were damaged and have been made anew", said)
        self.assertEqual([warm, without, damaged], [cold] * 3)

    def test_a_replay_prepares_everything_itself(self):
        self.run_scene("iso_fit.lua")
        for path in self.entries():
            os.remove(path)
        done = self.run_program("replay", self.path("run.h5"), "--verify", env=self.environment)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.entries(), [])


if __name__ == "__main__":
    unittest.main()
