"""A run file holds all that is needed to simulate again; what differs is found and named."""
import os
import shutil
import unittest

import h5py
import numpy

from program import ProgramTest, SMALL


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

    def test_without_embedded_inputs_there_is_nothing_to_replay(self):
        run_file, _ = self.small_run("--no-embed")
        self.refuse(3, "--no-embed", "replay", run_file)

    def test_a_flipped_bit_anywhere_is_found_or_harmless(self):
        """Flips one bit at a hundred places of the file: replay never says equal for a file whose data differ, and never
        crashes. Padding, free space and wall clock may change unseen."""
        run_file, _ = self.small_run("--duration", "0.05")
        with open(run_file, "rb") as f:
            content = f.read()
        with h5py.File(run_file) as f:
            before = {k: f[k][()].tobytes() for k in ["/state/body/box/pose", "/state/hash", "/cost/contacts"]}
        damaged = self.path("damaged.h5")
        for i in range(100):
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
