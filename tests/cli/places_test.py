"""Where a command stands and what leads to its files: a folder that is gone, one that may not be read or written,
symbolic links. Each works, or ends with one line."""
import os
import subprocess
import time
import unittest

import h5py

from program import ProgramTest, SMALL, VERISIM

NOBODY = 65534


def become_nobody():
    """In a child: permissions do not hold root back."""
    if os.getuid() == 0:
        os.setgroups([])
        os.setgid(NOBODY)
        os.setuid(NOBODY)


class Places(ProgramTest):
    def setUp(self):
        super().setUp()
        self.write("small.lua", SMALL)
        os.chmod(self.folder, 0o755)
        self.addCleanup(subprocess.run, ["chmod", "-R", "u+rwx", self.folder])

    def refuse_at(self, folder, code, words, *command, before="", **options):
        quoted = " ".join(f"'{word}'" for word in [VERISIM, *command])
        done = subprocess.run(["bash", "-c", f"cd '{folder}' && {before or ':'} && {quoted}"], capture_output=True,
                              text=True, timeout=60, **options)
        self.assertEqual(done.returncode, code, done.stderr)
        errors = [line for line in done.stderr.splitlines() if line.startswith("error: ")]
        self.assertEqual(len(errors), 0 if code == 0 else 1, done.stderr)
        for word in words:
            self.assertIn(word, errors[0])

    def in_a_deleted_folder(self, code, words, *command):
        gone = self.path("gone")
        os.mkdir(gone)
        self.refuse_at(gone, code, words, *command, before=f"rmdir '{gone}'")

    def test_a_working_directory_that_was_deleted(self):
        scenario, out = self.path("small.lua"), self.path("a.h5")
        self.in_a_deleted_folder(0, [], "run", scenario, "-o", out, "--quiet")
        self.in_a_deleted_folder(0, [], "replay", out, "--verify")
        self.in_a_deleted_folder(5, ["runs/small.h5"], "run", scenario)
        self.succeed("trace", "synth", "sine", "-o", "t.csv", "--set", "duration=0.1")
        self.in_a_deleted_folder(0, [], "trace", "convert", self.path("t.csv"), "-o", self.path("u.csv"))
        self.write("bound.lua", SMALL + 'addDevice(Devices.Sensable.PhantomOmni{ name = "omni" })\n')
        self.in_a_deleted_folder(0, [], "run", self.path("bound.lua"), "-o", out, "--quiet", "--bind",
                                 "omni=" + self.path("t.csv"))
        self.in_a_deleted_folder(3, ["working directory"], "run", "small.lua", "-o", out)
        self.in_a_deleted_folder(3, ["a.h5"], "replay", "a.h5")
        self.in_a_deleted_folder(3, ["working directory"], "trace", "info", "t.csv")
        self.in_a_deleted_folder(5, ["t.csv"], "trace", "synth", "sine", "-o", "t.csv")
        self.in_a_deleted_folder(0, [], "--help")

    def test_a_working_directory_that_may_not_be_entered(self):
        closed = self.path("closed")
        os.mkdir(closed)
        anyones = self.path("anyones")
        os.mkdir(anyones)
        os.chmod(anyones, 0o777)
        quoted = f"'{VERISIM}'"
        for command, code in ((f"run '{self.path('small.lua')}' -o '{anyones}/run.h5' --quiet", 0),
                              (f"run '{self.path('small.lua')}'", 5), ("run small.lua", 3), ("replay a.h5", 3)):
            # The shell stands in the folder before its permissions go.
            done = subprocess.run(["bash", "-c", f"{quoted} {command}"],
                                  cwd=closed, preexec_fn=lambda: (os.chmod(closed, 0), become_nobody()),
                                  capture_output=True, text=True, timeout=60)
            os.chmod(closed, 0o755)
            self.assertEqual(done.returncode, code, (command, done.stderr))
            self.assertEqual(done.stderr.count("error: "), 0 if code == 0 else 1, done.stderr)

    def test_a_link_to_a_scenario_is_the_scenario(self):
        """Its folder is that of what the link leads to: there are its models and scripts."""
        os.makedirs(self.path("project/parts"))
        self.write("project/real.lua", 'dofile("parts/one.lua")\n')
        self.write("project/parts/one.lua", SMALL)
        os.mkdir(self.path("elsewhere"))
        os.symlink(self.path("project/real.lua"), self.path("elsewhere/link.lua"))
        os.symlink("link.lua", self.path("elsewhere/chain.lua"))
        os.symlink("elsewhere", self.path("folder"))
        for name in ("elsewhere/link.lua", "elsewhere/chain.lua", "folder/link.lua"):
            summary = self.run_json("run", name)
            self.assertEqual(summary["scenario"], "real.lua")
            self.assertEqual(summary["run_file"], "runs/real.h5")
        self.succeed("replay", "runs/real.h5", "--verify")
        os.symlink("nowhere", self.path("broken.lua"))
        os.symlink("round.lua", self.path("round.lua"))
        self.refuse(3, "broken.lua", "run", "broken.lua")
        self.refuse(3, "round.lua", "run", "round.lua")

    def killed_run(self, folder):
        os.makedirs(folder, exist_ok=True)
        run_file = os.path.join(folder, "killed.h5")
        process = subprocess.Popen([VERISIM, "run", self.path("small.lua"), "-o", run_file, "--duration", "600", "--quiet"])
        while not os.path.exists(run_file):
            self.assertIsNone(process.poll())
            time.sleep(0.002)
        time.sleep(0.2)
        process.kill()
        process.wait()
        return run_file

    def as_nobody(self, *command):
        return subprocess.run([VERISIM, *command], cwd="/", preexec_fn=become_nobody, capture_output=True, text=True,
                              timeout=120)

    def test_a_killed_runs_file_in_a_folder_that_may_not_be_written(self):
        folder = self.path("fixed")
        run_file = self.killed_run(folder)
        with open(run_file, "rb") as f:
            before = f.read()
        os.chmod(run_file, 0o444)
        os.chmod(folder, 0o555)
        replayed = self.as_nobody("replay", run_file, "--verify")
        self.assertEqual(replayed.returncode, 0, replayed.stderr)
        self.assertIn("notice: ", replayed.stderr)
        self.assertIn("killed run", replayed.stderr)
        recovered = self.as_nobody("recover", run_file)
        self.assertEqual(recovered.returncode, 5, recovered.stderr)
        self.assertEqual(recovered.stderr.count("error: "), 1)
        self.assertIn("fixed/killed.h5", recovered.stderr)
        with open(run_file, "rb") as f:
            self.assertEqual(f.read(), before)
        self.assertEqual(os.listdir(folder), ["killed.h5"])

    def test_a_link_to_a_killed_runs_file_stays_a_link(self):
        run_file = self.killed_run(self.path("far"))
        os.symlink(run_file, self.path("link.h5"))
        self.assertIn("frames kept", self.succeed("recover", "link.h5").stdout)
        self.assertTrue(os.path.islink(self.path("link.h5")))
        with h5py.File(run_file):
            pass

    def test_what_stands_where_a_recovery_works_is_kept(self):
        run_file = self.killed_run(self.path("far"))
        self.write("far/killed.h5.recovering", "my notes\n")
        self.refuse(5, "killed.h5.recovering", "recover", run_file)
        with open(self.path("far/killed.h5.recovering")) as f:
            self.assertEqual(f.read(), "my notes\n")


if __name__ == "__main__":
    unittest.main()
