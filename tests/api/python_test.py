"""The Python module: fields, tables, errors, frames. Against h5py, which shares no code with it."""
import contextlib
import io
import json
import os
import shutil
import signal
import subprocess
import sys
import threading
import unittest
import unittest.mock

import h5py
import numpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "cli"))
from program import SMALL, SOURCE, VERISIM, ProgramTest  # noqa: E402

sys.path.insert(0, os.path.join(os.path.dirname(VERISIM), "python"))
import verisim  # noqa: E402


class PythonModule(ProgramTest):
    def setUp(self):
        super().setUp()
        self.scenario = self.write("small.lua", SMALL)

    def run_small(self, parameters=None, **more):
        return verisim.run(self.scenario, parameters, **{"duration": 0.3, "out": self.path("a.h5"), **more})

    def test_every_field_is_what_h5py_reads(self):
        run = self.run_small()
        with h5py.File(self.path("a.h5")) as file:
            self.assertGreater(len(run), 30)
            for path, field in run.fields.items():
                numpy.testing.assert_array_equal(run[path], file[path][()], path)
                self.assertEqual(run[path].dtype, file[path].dtype, path)
                self.assertEqual(field.units, file[path].attrs["units"], path)
            self.assertEqual(run.summary["state_hash"] if "state_hash" in run.summary else run.attributes["state_hash"],
                             file.attrs["state_hash"])
            events = file["events"][()]
            self.assertEqual([e.text for e in run.events], [e["text"].decode() for e in events])
            self.assertGreater(len(events), 0)

    def test_nothing_is_read_before_it_is_asked_for_and_then_once(self):
        run = self.run_small()
        self.assertEqual(run._read, {})
        self.assertIs(run["state/time"], run["/state/time"])
        self.assertEqual(list(run._read), ["/state/time"])
        with self.assertRaises(ValueError):
            run["state/time"][0] = 1

    def test_a_run_that_was_replaced_stays_what_it_was(self):
        first = self.run_small(seed=1)
        self.run_small(duration=0.1, seed=2)
        self.assertEqual((first.frames, first["state/time"].shape), (300, (300,)))

    def test_tables(self):
        run = self.run_small()
        table = run.to_pandas()
        self.assertEqual(len(table), 300)
        numpy.testing.assert_array_equal(table["state/body/box/pose.2"], run["state/body/box/pose"][:, 2])
        numpy.testing.assert_array_equal(table.index, run["state/time"])
        self.assertEqual(table.attrs["units"]["state/body/box/force.0"], "N, N m")
        self.assertFalse([c for c in table.columns if c.startswith("state/links/")])
        with self.assertRaisesRegex(ValueError, "no row in every frame"):
            run.to_pandas(["state/links/wrench"])
        self.assertEqual(list(run.to_pandas("state/time").columns), ["state/time"], "one needs no list")
        for table_of in (run.to_pandas, run.to_xarray):
            with self.assertRaisesRegex(verisim.Failure, "did you mean '/state/body/box/pose'"):
                table_of(["state/body/box/pos"])
        data = run.to_xarray()
        self.assertEqual(set(data.data_vars), {path.lstrip("/") for path in run.fields})
        self.assertEqual(data["state/body/box/pose"].dims, ("frame", "pose"))
        self.assertEqual(data["state/links/wrench"].sizes["state/links/row"], len(run["state/links/pair"]))
        self.assertEqual(data["state/body/box/pose"].attrs["units"], "m, 1")
        self.assertEqual(data["time"].dims, ("frame",))
        # Two widths of one name: a robot's pose on the floor has 3 numbers, a body's 7.
        robot = verisim.run(os.path.join(SOURCE, "scenarios", "robot_gain.lua"), duration=0.02, out=self.path("r.h5"))
        data = robot.to_xarray()
        self.assertEqual(set(data.data_vars), {path.lstrip("/") for path in robot.fields})

    def test_texts_that_are_damaged_are_failures(self):
        self.run_small()
        for name, text in (("parameters", b"{"), ("parameters", b"\xff\xfe"), ("scenario", b"\xff\xfe")):
            damaged = shutil.copy(self.path("a.h5"), self.path(f"damaged{len(os.listdir(self.folder))}.h5"))
            with h5py.File(damaged, "r+") as file:
                file.attrs[name] = numpy.bytes_(text)
            with self.assertRaisesRegex(verisim.Failure, "damaged.*the file is damaged"):
                verisim.Run(damaged).parameters  # noqa: B018

    def test_each_frame_sees_what_is_recorded_and_may_end_the_run(self):
        seen = []

        def each_frame(frame):
            seen.append((frame.number, frame.time, frame.pose("box"), frame.velocity("box"), frame.contact_wrench("box")))
            return frame.number < 40

        run = self.run_small(each_frame=each_frame)
        self.assertEqual(run.frames, 40)
        self.assertEqual([s[0] for s in seen], list(range(1, 41)))
        for i, path in ((2, "pose"), (3, "twist"), (4, "force")):
            numpy.testing.assert_array_equal([s[i] for s in seen], run[f"state/body/box/{path}"])

    def test_what_a_callback_throws_comes_out_and_the_file_is_readable(self):
        def each_frame(frame):
            if frame.number == 20:
                raise KeyError("mine")

        with self.assertRaisesRegex(KeyError, "mine"):
            self.run_small(each_frame=each_frame)
        run = verisim.Run(self.path("a.h5"))
        self.assertEqual((run.frames, run.summary["end"]), (20, "interrupted"))

    def test_bad_input_is_a_failure_that_says_what_to_do(self):
        for wanted, call in (
                ("did you mean 'voxelsize'", lambda: self.run_small(voxelsiez=1)),
                ("nowhere.lua", lambda: verisim.run(self.path("nowhere.lua"))),
                ("shorter than one frame", lambda: self.run_small(duration=1e-9)),
                ("threads", lambda: self.run_small(threads=0)),
                ("/dev/full", lambda: self.run_small(out="/dev/full")),
                ("out: is empty; name a run file", lambda: self.run_small(out="")),
                ("scenario: is empty; name a Lua file", lambda: verisim.run("", out=self.path("a.h5"))),
                ("out: is empty; name a folder", lambda: verisim.batch(self.scenario, "")),
                ("out has a control character .0x0a", lambda: self.run_small(out=self.path("a\nb.h5"))),
                ("is not an HDF5 file", lambda: verisim.Run(self.scenario)),
                ("holds no batch", lambda: verisim.Batch(self.folder))):
            with self.subTest(wanted), self.assertRaisesRegex(verisim.Failure, wanted):
                call()
        run = self.run_small()
        with self.assertRaisesRegex(verisim.Failure, "did you mean '/state/body/box/pose'"):
            run["state/body/box/poes"]
        with self.assertRaisesRegex(verisim.Failure, "no body is called 'bxo'; did you mean 'box'"):
            self.run_small(each_frame=lambda frame: frame.pose("bxo"))

    def test_values_of_another_kind_are_failures_that_say_what_is_wanted(self):
        self.run_small()
        before = sorted(os.listdir(self.folder))

        def batch(**more):
            return verisim.batch(self.scenario, self.path("b"), **more)

        for wanted, call in (
                ("seed: -1 is no whole number from 0 to 18446744073709551615", lambda: self.run_small(seed=-1)),
                ("seed: 18446744073709551616 is no whole", lambda: self.run_small(seed=2**64)),
                ("seed: 1.5 is no whole", lambda: self.run_small(seed=1.5)),
                ("seed: 'x' is no whole", lambda: self.run_small(seed="x")),
                ("seed: True is no whole", lambda: self.run_small(seed=True)),
                ("threads: -1 is no whole number from 1 to 256", lambda: self.run_small(threads=-1)),
                ("threads: None is no whole", lambda: self.run_small(threads=None)),
                ("duration: '1s' is no time above 0; give seconds as a number", lambda: self.run_small(duration="1s")),
                ("duration: -1 is no time", lambda: self.run_small(duration=-1)),
                ("duration: nan is no time", lambda: self.run_small(duration=float("nan"))),
                ("duration: inf is no time", lambda: self.run_small(duration=float("inf"))),
                ("force: 'yes' is neither True nor False", lambda: self.run_small(force="yes")),
                ("prepared: None is neither True nor False", lambda: self.run_small(prepared=None)),
                ("each_frame: 3 cannot be called", lambda: self.run_small(each_frame=3)),
                ("binds: .'a'. is no dict", lambda: self.run_small(binds=["a"])),
                ("bind hand: 3 is no path", lambda: self.run_small(binds={"hand": 3})),
                ("parameters: 7 is no dict", lambda: self.run_small(7)),
                ("a parameter's name: 1 is no text", lambda: self.run_small({1: 2})),
                ("word: None is no value of a parameter", lambda: self.run_small(word=None)),
                ("word: {'a': 1} is no value of a parameter", lambda: self.run_small(word={"a": 1})),
                ("scenario: None is no path", lambda: verisim.run(None, out=self.path("a.h5"))),
                ("out: 3 is no path", lambda: self.run_small(out=3)),
                ("path: 3 is no path", lambda: verisim.Run(3)),
                ("3 is no name of a field", lambda: verisim.Run(self.path("a.h5"))[3]),
                ("3 is no body's name", lambda: self.run_small(out=self.path("f.h5"), each_frame=lambda frame: frame.pose(3))),
                ("seed: -1 is no whole", lambda: batch(seed=-1)),
                ("repeat: 'x' is no whole number from 1", lambda: batch(repeat="x")),
                ("jobs: 0 is no whole number from 1 to 4096", lambda: batch(jobs=0)),
                ("duration: 'x' is no time", lambda: batch(duration="x")),
                ("time_limit: 0 is no time", lambda: batch(time_limit=0)),
                ("measure: 'yes' is neither", lambda: batch(measure="yes")),
                ("retry_failed: 'yes' is neither", lambda: batch(retry_failed="yes")),
                ("vary: .'word'. is no dict", lambda: batch(vary=["word"])),
                ("word: None is no value", lambda: batch(vary={"word": [None]})),
                ("random: 5 is no number of draws with a dict", lambda: batch(random=5)),
                ("random: 'x' is no dict", lambda: batch(random=(2, "x"))),
                ("keep: 3 is no text", lambda: batch(keep=3)),
                ("keep.*some", lambda: batch(keep="some")),
                ("folder: None is no path", lambda: verisim.Batch(None))):
            with self.subTest(wanted), self.assertRaisesRegex(verisim.Failure, wanted) as raised:
                call()
            self.assertNotIn("pybind", str(raised.exception))
            self.assertNotIn("incompatible", str(raised.exception))
        with contextlib.suppress(FileNotFoundError):
            os.remove(self.path("f.h5"))
        self.assertEqual(sorted(os.listdir(self.folder)), before, "nothing was begun")
        # What is as good as an int, a bool or a number is taken, NumPy's among them.
        run = self.run_small({"speed": numpy.float64(0.4)}, seed=numpy.int64(7), duration=numpy.float32(0.25), force=numpy.bool_(True),
                             threads=numpy.uint8(1))
        self.assertEqual((run.attributes["seed"], run.frames, run.parameters["speed"]), (7, 250, 0.4))
        self.assertEqual(batch(vary={"speed": 0.4}, duration=0.01).rows()[0]["speed"], 0.4)
        with self.assertRaisesRegex(verisim.Failure, "index.sqlite: no such column"):
            verisim.Batch(self.path("b")).rows("SELECT nowhere FROM run")

    def test_an_answer_of_each_frame_is_true_or_false_as_python_has_it(self):
        for answer, frames in (("", 1), ([], 1), ("go on", 300), (None, 300), (numpy.bool_(False), 1)):
            self.assertEqual(self.run_small(each_frame=lambda frame, a=answer: a).frames, frames, answer)

    def test_a_batch_does_again_what_has_no_answer(self):
        with self.assertWarnsRegex(RuntimeWarning, "--retry-failed does them again"):
            verisim.batch(self.scenario, self.path("b"), vary={"duration": [0.05, 1e4]}, time_limit=0.5)
        with self.assertWarnsRegex(RuntimeWarning, "no answer within 1 s"):
            again = verisim.batch(self.scenario, self.path("b"), vary={"duration": [0.05, 1e4]}, time_limit=1, retry_failed=True)
        self.assertEqual([row["status"] for row in again.rows()], ["done", "timeout"])

    def test_a_text_that_would_be_cut_at_a_nul_is_a_value_error(self):
        self.run_small()
        before = sorted(os.listdir(self.folder))
        cut, a = "\0.h5", self.path("a.h5")
        for wanted, call in (
                ("scenario has a NUL", lambda: verisim.run(self.scenario + cut, out=a)),
                ("scenario has a NUL", lambda: verisim.run(self.scenario.encode() + b"\0", out=a)),
                ("scenario is not UTF-8", lambda: verisim.run("\udcff.lua", out=a)),
                ("out has a NUL", lambda: self.run_small(out=a + cut)),
                ("a parameter's name has a NUL", lambda: self.run_small({"word" + cut: "b"})),
                ("word has a NUL", lambda: self.run_small(word="b" + cut)),
                ("the name of a bind has a NUL", lambda: self.run_small(binds={"hand" + cut: a})),
                ("bind hand has a NUL", lambda: self.run_small(binds={"hand": a + cut})),
                ("path has a NUL", lambda: verisim.Run(a + cut)),
                ("folder has a NUL", lambda: verisim.Batch(a + cut)),
                ("scenario has a NUL", lambda: verisim.batch(self.scenario + cut, self.path("b"))),
                ("out has a NUL", lambda: verisim.batch(self.scenario, self.path("b") + cut)),
                ("design has a NUL", lambda: verisim.batch(self.scenario, self.path("b"), design=a + cut)),
                ("what varies has a NUL", lambda: verisim.batch(self.scenario, self.path("b"), vary={"word" + cut: ["a"]})),
                ("word has a NUL", lambda: verisim.batch(self.scenario, self.path("b"), vary={"word": ["a", cut]})),
                ("random has a NUL", lambda: verisim.batch(self.scenario, self.path("b"), random=(2, {"speed": "1..2" + cut}))),
                ("bind hand has a NUL", lambda: verisim.batch(self.scenario, self.path("b"), binds={"hand": a + cut}))):
            with self.subTest(wanted), self.assertRaisesRegex(ValueError, wanted):
                call()
        with self.assertRaisesRegex(verisim.Failure, r"no field is called '/state/time\\x00s'; did you mean '/state/time'"):
            verisim.Run(a)["state/time\0s"]  # noqa: B018
        self.assertEqual(sorted(os.listdir(self.folder)), before)

    def test_the_library_refuses_such_a_text_too(self):
        from verisim import _verisim
        for wanted, change in (("scenario has a control character .0x00", {"scenario": self.scenario + "\0"}),
                               ("out has a control character .0x00", {"out": self.path("a.h5\0b")}),
                               ("a parameter's name has a control", {"parameters": [("word\0", "b")]}),
                               ("word has a control character", {"parameters": [("word", "b\0")]}),
                               ("bind hand has a control", {"binds": [("hand", "b\0")]}),
                               ("a bind's name has a control", {"binds": [("hand\0", "b")]})):
            request = _verisim.RunRequest()
            for name, value in {"scenario": self.scenario, "out": self.path("a.h5"), **change}.items():
                setattr(request, name, value)
            with self.subTest(wanted), self.assertRaisesRegex(verisim.Failure, wanted):
                _verisim.run(request, None)
        with self.assertRaisesRegex(verisim.Failure, "path has a control character .0x00"):
            _verisim.RunFile(self.path("a.h5\0b"))

    def test_a_frame_that_was_kept_says_that_it_is_over(self):
        kept = []
        self.run_small(each_frame=kept.append)
        for look in (lambda frame: frame.number, lambda frame: frame.bodies, lambda frame: frame.pose("box")):
            with self.assertRaisesRegex(verisim.Failure, "this frame is over"):
                look(kept[0])

    def test_parameters_that_are_named_like_keywords(self):
        run = self.run_small({"duration": 0.2, "voxelsize": "20mm"}, duration=None, word="b")
        self.assertEqual((run.frames, run.parameters["voxelsize"], run.parameters["word"]), (200, 0.02, "b"))
        with self.assertRaisesRegex(verisim.Failure, "word: is given twice"):
            self.run_small({"word": "a"}, word="b")

    def test_what_the_program_warns_of_is_a_warning(self):
        cache = self.path("cache")
        with unittest.mock.patch.dict(os.environ, {"VERISIM_CACHE": cache}):
            self.run_small()
            for entry in os.listdir(cache):
                with open(os.path.join(cache, entry), "r+b") as f:
                    f.truncate(os.path.getsize(f.name) // 2)
            with self.assertWarnsRegex(RuntimeWarning, "were damaged and have been made anew"):
                run = self.run_small()
            self.assertIn("damaged", run.warnings[0])

    def test_what_the_scenario_says_comes_out_as_pythons(self):
        scenario = self.write("say.lua", SMALL + """
print("built")
Actions.addFrameAction(function() Actions.waitSeconds(0.1) print("ran") error("no further") end)""")
        said = io.StringIO()
        with contextlib.redirect_stderr(said), self.assertWarnsRegex(RuntimeWarning, "no further"):
            verisim.run(scenario, out=self.path("a.h5"))
        self.assertEqual(said.getvalue(), "built\nran\n")

    def test_bad_input_that_is_met_on_the_way_is_a_failure(self):
        scenario = self.write("near.lua", """
defineSimulationParameters{ duration = 1 }
addObject{ name = "plate", fixed = true, voxelsize = 1e-7, Solid.box{0.3, 0.3, 0.02} }
local box = addObject{ name = "box", voxelsize = 0.01, position = {0, 0, 2}, Solid.box{0.06, 0.06, 0.04} }
local hand = Devices.Hand{ name = "hand", path = { {position = {0, 0, 2}} } }
addDevice(hand)
grasp(hand, box)
Actions.addFrameAction(function() Actions.waitSeconds(0.1) box.position = {0, 0, 0.03} end)""")
        with self.assertRaisesRegex(verisim.Failure, "plate.*voxel"):
            verisim.run(scenario, out=self.path("a.h5"))
        self.assertGreater(verisim.Run(self.path("a.h5")).frames, 90)

    def test_a_batch_tells_what_the_program_says(self):
        with self.assertWarnsRegex(RuntimeWarning, "run 0 .word=no.*failed: .*: no"):
            batch = verisim.batch(self.write("odd.lua", SMALL.replace("local box", "if p.word == 'no' then error('no') end local box")),
                                  self.path("b"), vary={"word": ["no", "yes"]}, duration=0.05)
        self.assertEqual([row["status"] for row in batch.rows()], ["failed", "done"])
        with self.assertRaisesRegex(verisim.Failure, "word: 'a,b': a comma parts values"):
            verisim.batch(self.scenario, self.path("c"), vary={"word": ["a,b"]})
        batch = verisim.batch(self.scenario, self.path("d"), {"duration": 0.05}, vary={"word": ["'a,b'", "c"]})
        self.assertEqual([row["word"] for row in batch.rows()], ["a,b", "c"])

    def test_a_run_that_diverges_is_a_run(self):
        scenario = self.write("far.lua", """
defineSimulationParameters{ duration = 1, gravity = {0, 0, -1e308}, allBodiesAreDynamic = true }
addObject{ name = "box", voxelsize = 0.01, Solid.box{0.06, 0.06, 0.04} }""")
        with self.assertWarnsRegex(RuntimeWarning, "not a finite number"):
            run = verisim.run(scenario, out=self.path("far.h5"))
        self.assertEqual(run.figures["end"], "diverged")
        self.assertIn("not a finite number", run.error)

    def test_ctrl_c_ends_a_run(self):
        # Who starts the tests in the background has them ignore SIGINT, and Python then leaves it so.
        code = f"""
import signal, sys, time
signal.signal(signal.SIGINT, signal.default_int_handler)
sys.path.insert(0, {os.path.dirname(VERISIM) + "/python"!r})
import verisim
def each_frame(frame):
    if frame.number == 1:
        print("on", flush=True)
    time.sleep(0.01)
try:
    verisim.run({self.scenario!r}, duration=20, out="long.h5", each_frame=each_frame)
except KeyboardInterrupt:
    print("interrupted", verisim.Run("long.h5").frames > 0)
"""
        process = subprocess.Popen(["/usr/bin/python3", "-c", code], cwd=self.folder, stdout=subprocess.PIPE, text=True)
        self.addCleanup(process.kill)
        self.assertEqual(process.stdout.readline(), "on\n")
        process.send_signal(signal.SIGINT)
        said, _ = process.communicate(timeout=60)
        self.assertEqual(said, "interrupted True\n")

    def test_runs_in_several_threads_are_what_they_are_alone(self):
        from concurrent.futures import ThreadPoolExecutor
        with ThreadPoolExecutor(4) as pool:
            hashes = list(pool.map(
                lambda i: self.run_small(seed=i % 2, out=self.path(f"t{i}.h5")).figures["state_hash"], range(8)))
        for seed in (0, 1):
            alone = self.run_json("run", self.scenario, "--seed", seed, "--duration", 0.3, "-o", self.path("p.h5"))
            self.assertEqual(set(hashes[seed::2]), {alone["state_hash"]})

    def in_own_folder(self):
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(self.folder)

    def test_threads_without_out_have_a_file_each(self):
        from concurrent.futures import ThreadPoolExecutor
        self.in_own_folder()
        together = threading.Barrier(3, timeout=60)

        def one(seed):
            return verisim.run("small.lua", seed=seed, each_frame=lambda frame: frame.number > 1 or together.wait() >= 0)

        with ThreadPoolExecutor(3) as pool:
            runs = list(pool.map(one, range(3)))
        self.assertEqual({run.path for run in runs}, {"runs/small.h5", "runs/small-2.h5", "runs/small-3.h5"})
        for seed, run in enumerate(runs):
            self.assertEqual((run.attributes["seed"], run.summary["state_hash"] if "state_hash" in run.summary else
                              run.attributes["state_hash"]), (seed, run.figures["state_hash"]))
        self.assertEqual(verisim.run("small.lua", duration=0.1).path, "runs/small.h5")

    def test_a_default_name_that_another_run_has_is_another(self):
        self.in_own_folder()
        inner = []

        def each_frame(frame):
            if frame.number == 200:  # its file has its name
                inner.append(verisim.run("small.lua", duration=0.1))
                inner.append(json.loads(self.succeed("run", "small.lua", "--duration", "0.1", "--json").stdout))
                with self.assertRaisesRegex(verisim.Failure, "another run is writing it"):
                    verisim.run("small.lua", out="runs/small.h5")

        outer = verisim.run("small.lua", out="runs/small.h5", each_frame=each_frame)
        self.assertEqual((outer.frames, inner[0].path, inner[0].frames), (300, "runs/small-2.h5", 100))
        self.assertEqual(inner[1]["run_file"], "runs/small-2.h5")

    def test_the_json_of_a_run_is_the_programs(self):
        run = self.run_small()
        plain = self.run_json("run", self.scenario, "--duration", 0.3, "-o", self.path("p.h5"))
        self.assertEqual(list(run.figures), list(plain))
        self.assertEqual(json.dumps(run.figures["outcome"]), json.dumps(plain["outcome"]))


if __name__ == "__main__":
    unittest.main()
