"""Streams that are closed, full, or that nobody reads any more: nothing that was said is lost in silence, and nothing of
it goes into a file."""
import os
import subprocess
import unittest

import h5py

from program import ProgramTest, SMALL, VERISIM


class Streams(ProgramTest):
    def setUp(self):
        super().setUp()
        self.write("small.lua", SMALL)
        self.write("chatty.lua", 'print("a line that belongs to a stream")\n' + SMALL)
        self.succeed("run", "small.lua", "-o", "done.h5", "--quiet")
        self.succeed("trace", "synth", "sine", "-o", "t.csv", "--set", "duration=0.1")

    HELPS = [[], ["run"], ["replay"], ["recover"], ["inspect"], ["trace"], ["trace", "info"], ["trace", "convert"],
             ["trace", "synth"], ["wii"], ["wii", "validate"], ["wii", "place"], ["wii", "track"], ["wii", "serve"],
             ["wii", "listen"], ["reproduce"], ["doctor"]]
    TALKERS = [["--version"], *([*words, "--help"] for words in HELPS),
               ["run", "small.lua", "-o", "a.h5"], ["run", "small.lua", "-o", "a.h5", "--json"],
               ["replay", "done.h5"], ["replay", "done.h5", "--verify", "--json"], ["recover", "done.h5"],
               ["trace", "info", "t.csv"], ["trace", "info", "t.csv", "--json"], ["doctor"],
               ["wii", "place", "--count", "10", "--samples", "100"],
               ["wii", "validate", "--tracker", "geometric", "--trajectory", "static", "--sensor", "ideal"],
               ["wii", "serve", "--trajectory", "static", "--port", "0", "--duration", "0.1"]]
    WARNERS = [["run", "chatty.lua", "-o", "a.h5"], ["run", "none.lua"], ["run"], ["fly"], ["replay", "none.h5"],
               ["trace", "info", "none.csv"], ["inspect", "none.step"]]

    def shell(self, command, redirection):
        quoted = " ".join(f"'{word}'" for word in [VERISIM, *command])
        return subprocess.run(["bash", "-c", f"{quoted} {redirection}"], cwd=self.folder, capture_output=True, text=True,
                              timeout=120)

    def test_stdout_that_is_full_or_closed(self):
        for command in self.TALKERS:
            for how, why in ((">/dev/full", "No space left"), (">&-", "")):
                with self.subTest(command=command, how=how):
                    done = self.shell(command, how)
                    self.assertEqual(done.returncode, 5, done.stderr)
                    self.assertEqual(done.stderr.count("error: "), 1, done.stderr)
                    self.assertIn("error: stdout: ", done.stderr)
                    self.assertIn(why, done.stderr)

    def test_stderr_that_is_full_or_closed(self):
        for command in self.WARNERS:
            for how in ("2>/dev/full", "2>&-"):
                with self.subTest(command=command, how=how):
                    done = self.shell(command, how)
                    self.assertEqual(done.returncode, 5, done.stdout)
                    self.assertEqual(done.stdout.count("error: "), 1, done.stdout)

    def test_both(self):
        for command in self.TALKERS + self.WARNERS:
            for how in (">/dev/full 2>/dev/full", ">&- 2>&-", "<&- >&- 2>&-"):
                with self.subTest(command=command, how=how):
                    self.assertEqual(self.shell(command, how).returncode, 5)

    def test_nothing_said_is_nothing_lost(self):
        for how in (">/dev/full", ">&-", "2>&-", "2>/dev/full", "<&- >&- 2>&-"):
            self.assertEqual(self.shell(["run", "small.lua", "-o", "a.h5", "--quiet"], how).returncode, 0, how)

    def test_a_pipe_that_nobody_reads_is_quiet(self):
        for command in self.TALKERS:
            read, write = os.pipe()
            os.close(read)
            with self.subTest(command=command):
                done = subprocess.run([VERISIM, *command], cwd=self.folder, stdout=write, stderr=subprocess.PIPE, text=True)
                self.assertEqual(done.returncode, 5)
                self.assertNotIn("error", done.stderr)
            os.close(write)

    def test_no_file_takes_the_place_of_a_closed_stream(self):
        """The script's text would be written into whichever file got the number 1 or 2."""
        silent = self.path("silent.h5")
        chatty = SMALL + 'Actions.addFrameAction(function() while true do print("x") Actions.waitForRedraw() end end)\n'
        self.write("talks.lua", chatty)
        for closed in ("<&-", ">&-", "2>&-", "<&- >&-", "<&- 2>&-", ">&- 2>&-", "<&- >&- 2>&-"):
            with self.subTest(closed):
                self.shell(["run", "talks.lua", "-o", silent], closed)
                with h5py.File(silent) as f:
                    self.assertEqual(len(f["/state/time"]), 300)
                self.assertEqual(self.shell(["replay", silent, "--verify", "--quiet"], "").returncode, 0)

    def test_the_run_file_is_whole_though_nobody_heard_of_it(self):
        self.assertEqual(self.shell(["run", "small.lua", "-o", "a.h5", "--json"], ">/dev/full").returncode, 5)
        self.succeed("replay", "a.h5", "--verify")


class TheCadProgram(ProgramTest):
    """verisim-cad is started by verisim, and inherits its streams."""

    def test_closed_streams(self):
        cad = os.path.join(os.path.dirname(VERISIM), "verisim-cad")
        for closed in ("<&-", ">&-", "2>&-", "<&- >&- 2>&-"):
            done = subprocess.run(["bash", "-c", f"'{cad}' {closed} </dev/null" if closed != "<&-" else f"'{cad}' <&-"],
                                  capture_output=True, timeout=60)
            self.assertIn(done.returncode, (2, 3, 5), closed)


if __name__ == "__main__":
    unittest.main()
