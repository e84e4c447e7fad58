"""replay --verify finds whatever was changed in a run file, and names it; an honest run file it never refuses.

What is forged: every attribute of every object (value, another type, gone, one more), every dataset (first, last value,
a row less, a row more, gone), one more object in every group. What a simulation computes again
is held against it, and the message has both values; for all else the checksums say so.

Exempt, because nobody reads it as data: how HDF5 stores values (chunks, order of links and attributes, free space,
creation times, comments). A file that says that the run was interrupted is believed, if its checksums are right.
"""
import os
import random
import shutil
import signal
import subprocess
import time
import unittest

import h5py
import numpy

from program import ProgramTest, SMALL, VERISIM

ALL = os.environ.get("VERISIM_LONG_TESTS") == "1"
SANITIZED = os.environ["VERISIM_SANITIZE"] != ""  # ten times slower: fewer of each kind


def objects(f):
    """Path and object of everything in the file, "/" first."""
    found = [("/", f["/"])]
    f.visititems(lambda name, o: found.append(("/" + name, o)))
    return found


def other(value):
    """A value of the same type that is another one."""
    if isinstance(value, str):
        return value[:-1] + ("x" if value[-1:] != "x" else "y")
    if isinstance(value, bytes):
        return b"forged"
    array = numpy.array(value)
    if array.dtype.kind == "O":
        return numpy.array([other(v) for v in array.ravel()], dtype=object).reshape(array.shape)
    if array.dtype.kind == "f":
        return numpy.nextafter(array, array + 1)
    return array + array.dtype.type(1) if array.dtype.kind in "iu" else array


def flip(dataset, row):
    """Another value at one end of a dataset."""
    raw = dataset[row]
    if dataset.dtype.names:
        value = dataset[row]
        name = dataset.dtype.names[-1]
        value[name] = b"forged" if value.dtype[name].kind == "S" else value[name] + 1
        dataset[row] = value
        return
    flat = numpy.array(raw).ravel().copy()
    bits = flat.view("u%d" % flat.dtype.itemsize)
    bits[-1] ^= bits.dtype.type(1)
    dataset[row] = flat.reshape(numpy.shape(raw)) if numpy.shape(raw) else flat[0]


class Forged(ProgramTest):
    def forge(self, run_file, change, words, codes=(1,)):
        """A copy with the change is refused, in one line that has all of the words."""
        forged = self.path("forged.h5")
        shutil.copy(run_file, forged)
        with h5py.File(forged, "r+") as f:
            change(f)
        done = self.run_program("replay", forged, "--verify", timeout=60)
        lines = [line for line in done.stderr.splitlines() if line.startswith("error: ")]
        self.assertIn(done.returncode, codes, f"{words}: {done.stdout}{done.stderr}")
        self.assertEqual(len(lines), 1, f"{words}: {done.stderr}")
        if done.returncode == 1:
            for word in words:
                self.assertIn(word, lines[0])

    def honest(self):
        run_file, _ = self.small_run("--duration", "0.12")
        self.succeed("replay", run_file, "--verify")
        return run_file

    def test_every_attribute(self):
        run_file = self.honest()
        with h5py.File(run_file) as f:
            places = [(path, name) for path, o in objects(f) for name in o.attrs]
        roots = [p for p in places if p[0] in ("/", "/summary")]
        rest = [p for p in places if p not in roots]
        self.assertGreater(len(rest), 100)
        chosen = roots[::3 if SANITIZED else 1] + (rest if ALL else random.Random(1).sample(rest, 5 if SANITIZED else 25))
        for path, name in chosen:
            # What makes it a run file at all, or tells where the columns are, ends in "damaged".
            codes = (1, 3) if name in ("format", "format_version", "columns", "order", "names", "rows_where", "rows_in_frame") \
                else (1,)
            words = [name] if path in ("/", "/summary") and name != "checksums" else []
            if path.startswith("/inputs") or name in ("units", "description"):
                words = [path]
            with self.subTest(path=path, name=name, change="value"):
                def change(f):
                    f[path].attrs.modify(name, other(f[path].attrs[name]))
                self.forge(run_file, change, words, codes)

    def test_attributes_that_are_gone_or_more(self):
        run_file = self.honest()
        with h5py.File(run_file) as f:
            names = list(f.attrs)
            figures = list(f["/summary"].attrs)
        for path, name in [("/", n) for n in names[::3 if SANITIZED else 1]] + [("/summary", n) for n in (figures if ALL else figures[::16 if SANITIZED else 4])]:
            with self.subTest(path=path, name=name):
                def gone(f):
                    del f[path].attrs[name]
                self.forge(run_file, gone, [name], (1, 3) if name in ("format", "format_version", "columns") else (1,))
        with h5py.File(run_file) as f:
            paths = [path for path, _ in objects(f)]
        for path in paths if ALL else ["/", "/summary", "/inputs", "/state", "/state/links/pair", "/timing/overrun"]:
            with self.subTest(path=path):
                self.forge(run_file, lambda f: f[path].attrs.create("extra", 1), [path])

        def all_of_summary(f):
            for name in list(f["/summary"].attrs):
                del f["/summary"].attrs[name]
        self.forge(run_file, all_of_summary, ["/summary"])

        def another_type(f):
            f.attrs["seed"] = float(f.attrs["seed"])
        self.forge(run_file, another_type, ["seed"])

    def test_every_dataset(self):
        run_file = self.honest()
        with h5py.File(run_file) as f:
            sizes = {path: o.shape for path, o in objects(f) if isinstance(o, h5py.Dataset)}
        self.assertGreater(len(sizes), 40)
        for path, shape in sorted(sizes.items())[::4 if SANITIZED else 1]:
            if 0 in shape:
                continue
            # Counts that say where other columns' rows lie may make the file shorter or damaged.
            codes = (1, 3) if path.startswith(("/cost/links", "/cost/pairs_met")) else (1,)
            word = ["event"] if path == "/events" else ["frame"] if path.startswith(("/state/body", "/state/hash")) else \
                [] if path.startswith(("/cost/links", "/cost/pairs")) else [path]
            rows = [()] if not shape else [0, shape[0] - 1]
            for row in rows if ALL else rows[-1:]:
                with self.subTest(path=path, row=row):
                    self.forge(run_file, lambda f: flip(f[path], row), word, codes)

    def test_rows_and_objects_that_are_gone_or_more(self):
        run_file = self.honest()
        with h5py.File(run_file) as f:
            growing = [path for path, o in objects(f) if isinstance(o, h5py.Dataset) and o.maxshape[:1] == (None,)]
            groups = [path for path, o in objects(f) if isinstance(o, h5py.Group)]
        for path in growing if ALL else ["/state/body/box/pose", "/state/links/wrench", "/state/pairs", "/cost/contacts",
                                         "/timing/frame_ns", "/events", "/state/energy"]:
            for more in (-1, 1):
                with self.subTest(path=path, more=more):
                    self.forge(run_file, lambda f: f[path].resize(f[path].shape[0] + more, axis=0), [], (1, 3))
            with self.subTest(path=path, gone=True):
                def gone(f):
                    del f[path]
                self.forge(run_file, gone, [], (1, 3))
        for path in groups if ALL else ["/", "/summary", "/timing", "/inputs/files", "/state/body"]:
            with self.subTest(group=path):
                self.forge(run_file, lambda f: f[path].create_group("extra"), ["extra"], (1, 3))
                self.forge(run_file, lambda f: f[path].create_dataset("extra", data=[1.0]), ["extra"], (1, 3))

    def test_what_can_be_computed_again_is_held_against_it(self):
        """Not the checksum but the simulation says so: the message has both values."""
        run_file = self.honest()
        with h5py.File(run_file) as f:
            again = {("/", n) for n in ("dt", "parameters", "scenario", "scenario_sha256", "seed", "state_hash")}
            once = {"run_file", "wall_s", "load_s", "realtime_factor", "overruns", "realtime_priority"}
            again |= {("/summary", n) for n in f["/summary"].attrs if n not in once and "frame_ns" not in n}
        for path, name in sorted(again)[::4 if SANITIZED else 1]:
            with self.subTest(path=path, name=name):
                self.forge(run_file, lambda f: f[path].attrs.modify(name, other(f[path].attrs[name])),
                           [f"attribute '{name}' of {path}: stored", "simulat"])

    def test_what_the_run_file_promises_is_there(self):
        with h5py.File(self.honest()) as f:
            for name in ["format", "format_version", "scenario", "scenario_sha256", "parameters", "seed", "dt", "version",
                         "commit", "compiler", "cpu", "state_hash", "checksums"]:
                self.assertIn(name, f.attrs)
                self.assertNotEqual(f.attrs[name], "")

    def test_a_file_without_checksums_is_found_out(self):
        run_file = self.honest()

        def gone(f):
            del f.attrs["checksums"]
        self.forge(run_file, gone, ["checksums", "missing"])

        def pretends_to_be_old(f):
            f.attrs.modify("format_version", 1)
        self.forge(run_file, pretends_to_be_old, ["format_version"])


class Honest(ProgramTest):
    """An honest run never fails."""
    def verify(self, run_file):
        self.succeed("replay", run_file, "--verify")

    def test_whatever_the_scene_and_its_options(self):
        draw = random.Random(5)
        for i in range(200 if ALL else 4 if SANITIZED else 12):
            bodies = "".join(f"""
addObject{{ name = "b{k}", voxelsize = {draw.choice([0.004, 0.006, 0.01])}, density = {draw.uniform(50, 3000):.0f},
  position = {{{draw.uniform(-0.06, 0.06):.3f}, {draw.uniform(-0.06, 0.06):.3f}, {0.03 + 0.05 * k:.3f}}},
  {draw.choice(['Solid.box{0.04, 0.03, 0.02}', 'Solid.cylinder{radius=0.02, height=0.03}', 'Solid.sphere{radius=0.02}'])} }}
""" for k in range(draw.randint(1, 3)))
            script = f"""
local p = params{{ duration = 0.2, stiffness = {draw.uniform(100, 2000):.3f}, word = "a" }}
defineSimulationParameters{{ duration = p.duration, gravity = {{0, 0, -9.81}}, allBodiesAreDynamic = true,
  hybrid = "{draw.choice(['off', 'restore', 'blend', 'exact'])}", maxStiffness = p.stiffness, timestep = {draw.choice([0.0005, 0.001, 0.002])},
  integrator = "{draw.choice(['semi-implicit', 'implicit'])}" }}
addObject{{ name = "plate", fixed = true, voxelsize = 0.01, Solid.box{{0.3, 0.3, 0.02}} }}
{bodies}
local n = 0
Actions.addFrameAction(function()
  while true do n = n + 1; print("turn " .. n .. " \\195\\164\\195\\182" .. string.rep("\\195\\188", n * 12))
    measure("n", n, "1"); if n == {draw.randint(3, 9)} then outcome("done \\"so\\"") end; Actions.waitForRedraw() end
end)
"""
            options = draw.choice([[], ["--seed", "7"], ["--realtime"], ["--set", "word='x'"], ["--duration", "0.0305"],
                                   ["--threads", "2"], ["--set", "stiffness=1e3"]])
            with self.subTest(i=i, options=options):
                scenario = self.write("any.lua", script)
                run_file = self.path("any.h5")
                self.succeed("run", scenario, "-o", run_file, "--quiet", *options)
                self.verify(run_file)

    def test_with_two_heads_beside_it(self):
        scenario = self.write("heads.lua", SMALL + """
WiiHead{ name = "one", tracker = "geometric" }
WiiHead{ name = "two", tracker = "scaat", remote = { motion = "sweep-x" } }
""")
        run_file = self.path("heads.h5")
        self.succeed("run", scenario, "-o", run_file, "--quiet")
        with h5py.File(run_file) as f:
            self.assertEqual(sorted(f["state/wii"]), ["one", "two"])
        self.verify(run_file)

    def test_that_diverged(self):
        script = SMALL.replace("duration = p.duration", "duration = p.duration, gravity = {0, 0, -1e308}, "
                               "allBodiesAreDynamic = true")
        scenario = self.write("far.lua", script)
        done = self.run_program("run", scenario, "-o", self.path("far.h5"), "--quiet")
        self.assertEqual(done.returncode, 4, done.stderr)
        if os.path.exists(self.path("far.h5")):
            self.verify(self.path("far.h5"))

    def test_that_was_interrupted_or_killed(self):
        noisy = SMALL + """
Actions.addFrameAction(function() while true do for i = 1, 30 do print("line") end; Actions.waitForRedraw() end end)"""
        for options in [[], ["--realtime"]]:
            for kind in [signal.SIGINT, signal.SIGKILL]:
                for _ in range(20 if ALL else 3):
                    run_file = self.path("ended.h5")
                    if os.path.exists(run_file):
                        os.remove(run_file)
                    process = subprocess.Popen([VERISIM, "run", self.write("noisy.lua", noisy), "-o", run_file, "--quiet",
                                                "--duration", "600", *options], cwd=self.folder,
                                               stdout=subprocess.PIPE, stderr=subprocess.PIPE)
                    while not os.path.exists(run_file):
                        self.assertIsNone(process.poll())
                        time.sleep(0.002)
                    time.sleep(random.Random(_).uniform(0.05, 0.4))
                    process.send_signal(kind)
                    process.communicate(timeout=60)
                    with self.subTest(options=options, kind=kind):
                        self.verify(run_file)

    def test_of_another_version_with_a_notice(self):
        """As the checksums would be there: the notice needs no simulation to differ."""
        run_file, _ = self.small_run("--duration", "0.05")
        with h5py.File(run_file, "r+") as f:
            f.attrs.modify("version", "0.0.9")
        done = self.run_program("replay", run_file)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("notice: written by verisim 0.0.9", done.stderr)

    def test_that_left_its_inputs_out_cannot_be_replayed(self):
        run_file, _ = self.small_run("--no-embed")
        self.refuse(3, "--no-embed", "replay", run_file, "--verify")


if __name__ == "__main__":
    unittest.main()
