"""verisim batch that is killed, interrupted, divided, out of disk: the index is the same to the byte."""
import json
import os
import random
import resource
import subprocess
import time
import unittest

from batches import LIGHT, LIGHTER, LONG, MANY, SANITIZED, Batches, children

# Runs a shell command where DISK is a disk of SIZE, which nobody else sees and which is gone with it.
ON_A_DISK = ["unshare", "--user", "--map-root-user", "--mount", "sh", "-c",
             'mount -t tmpfs -o size="$SIZE" none "$DISK" && eval "$0"']

# A calendar that jumps back by a day at every look; the steady clock goes on.
JUMPING = """
#define _GNU_SOURCE
#include <sys/time.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>
static time_t jump;
int clock_gettime(clockid_t clock, struct timespec* t) {
  int failed = syscall(SYS_clock_gettime, clock, t);
  if (clock == CLOCK_REALTIME) t->tv_sec -= jump += 86400;
  return failed;
}
int gettimeofday(struct timeval* t, void* zone) {
  struct timespec now;
  clock_gettime(CLOCK_REALTIME, &now);
  t->tv_sec = now.tv_sec;
  t->tv_usec = 0;
  return 0;
}
time_t time(time_t* t) {
  struct timespec now;
  clock_gettime(CLOCK_REALTIME, &now);
  if (t) *t = now.tv_sec;
  return now.tv_sec;
}
"""


@unittest.skipIf(SANITIZED, "the sanitizers want to be loaded first")
class Clocks(Batches):
    def test_a_calendar_that_jumps_changes_nothing(self):
        library = self.path("jumping.so")
        subprocess.run(["cc", "-shared", "-fPIC", "-o", library, self.write("jumping.c", JUMPING)], check=True)
        args = ["--vary", "speed=0.4,0.5", "--vary", "misbehave=no,hang", "--time-limit", "3"]
        env = dict(os.environ, LD_PRELOAD=library)
        shown = subprocess.run(["date", "+%s"], env=env, capture_output=True, text=True).stdout
        self.assertLess(int(shown), time.time() - 80_000, "the calendar does not jump: this test would prove nothing")
        begin = time.monotonic()
        jumped = self.batch("jumped", *args, "--json", env=env)
        self.assertLess(time.monotonic() - begin, 60)
        self.assertEqual(jumped.returncode, 1, jumped.stderr)
        said = json.loads(jumped.stdout)
        self.assertEqual((said["done"], said["timeout"]), (2, 2))
        self.assertTrue(3 <= said["wall_s"] < 60)
        self.batch("plain", *args)
        self.assertEqual(self.index("jumped"), self.index("plain"))
        for row in self.rows("jumped", "timing.csv"):
            self.assertTrue(0 < float(row["process_s"]) < 60)


class Resumption(Batches):
    ARGS = ["--vary", "speed=0.4,0.45,0.5", "--vary", "misbehave=no,error", "--repeat", "2", *LIGHTER]

    def test_any_jobs_shards_and_interruptions_give_one_index(self):
        self.batch_json("whole", *self.ARGS, "--jobs", 1)
        self.batch_json("jobs", *self.ARGS, "--jobs", 5)
        self.assertEqual(self.index("whole"), self.index("jobs"))
        for i in (3, 1, 2):
            self.batch_json(f"s{i}", *self.ARGS, "--shard", f"{i}/3")
        shards = [self.path(f"s{i}") for i in (2, 3, 1)]
        said = self.run_json("batch", "merge", self.path("merged"), *shards)
        self.assertEqual((said["runs"], said["done"], said["failed"]), (12, 6, 6))
        self.assertEqual(self.index("whole"), self.index("merged"))
        self.refuse(3, ["missing", "4 of 12", "0, 3, 6, 9"], "batch", "merge", self.path("m2"), *shards[:2])
        self.refuse(3, ["twice", "1, 4, 7, 10"], "batch", "merge", self.path("m2"), *shards, shards[0])
        self.refuse(3, ["holds a batch already"], "batch", "merge", self.path("merged"), *shards)
        self.batch_json("other", "--vary", "speed=0.4,0.45", "--shard", "1/3")
        self.refuse(3, ["no shards of one batch", "vary"], "batch", "merge", self.path("m3"), *shards[:2],
                    self.path("other"))
        self.refuse(3, ["holds no batch"], "batch", "merge", self.path("m3"), self.folder)

    def test_killed_at_any_moment_it_goes_on_to_the_same_index(self):
        self.batch_json("whole", *self.ARGS, "--keep", "failed")
        took = time.monotonic()
        self.batch_json("again", *self.ARGS)
        took = time.monotonic() - took
        chance = random.Random(14)
        kills = 200 if LONG else 3 if SANITIZED else 10
        folder, done = 0, True
        while kills > 0:
            if done:
                folder += 1
            process = self.start(f"k{folder}", *self.ARGS, "--keep", "failed", "--quiet")
            time.sleep(chance.uniform(0, took / 2))
            done = process.poll() is not None
            process.kill()
            process.communicate()
            if done:
                self.assertEqual(self.index(f"k{folder}"), self.index("whole"))
            else:
                kills -= 1
        for i in range(1, folder + 1):
            self.batch_json(f"k{i}", *self.ARGS, "--keep", "failed")
            self.assertEqual(self.index(f"k{i}"), self.index("whole"), f"k{i}")
            with self.database(os.path.join(self.path(f"k{i}"), "index.sqlite")) as db:
                self.assertEqual(db.execute("SELECT count(*), count(DISTINCT run) FROM timing").fetchone(), (12, 12))

    def test_another_design_is_refused_and_named(self):
        self.batch_json("b", "--vary", "speed=0.4,0.5")
        self.assertEqual(self.batch_json("b", "--vary", "speed=400mm,0.5")["done"], 2, "the same, otherwise written")
        folder = ["batch", self.scenario, "-o", self.path("b")]
        self.refuse(3, ["another design", "vary/speed/values", "0.45", "-o"], *folder, "--vary", "speed=0.4,0.45")
        self.refuse(3, ["another design", "seed"], *folder, "--vary", "speed=0.4,0.5", "--seed", 2)
        self.refuse(3, ["another design", "repeat"], *folder, "--vary", "speed=0.4,0.5", "--repeat", 2)
        self.refuse(3, ["another design", "shard"], *folder, "--vary", "speed=0.4,0.5", "--shard", "1/2")
        self.refuse(3, ["another design", "set/duration"], *folder, "--vary", "speed=0.4,0.5", "--set", "duration=0.06")
        self.write("many.lua", MANY + "\n")
        self.refuse(3, ["another design", "scenario_sha256"], *folder, "--vary", "speed=0.4,0.5")

    def test_an_index_of_another_version_is_refused(self):
        self.batch_json("b", "--vary", "speed=0.4,0.5")
        folder = ["batch", self.scenario, "-o", self.path("b"), "--vary", "speed=0.4,0.5"]
        path = os.path.join(self.path("b"), "index.sqlite")
        with self.database(path) as db:
            db.execute("UPDATE meta SET value = '0.0.9 (commit 123)' WHERE name = 'version'")
        self.refuse(3, ["index.sqlite", "0.0.9", "go on with that version", "-o"], *folder)
        self.refuse(3, ["index.sqlite", "0.0.9", "go on with that version"], "batch", "merge", self.path("m"), self.path("b"))
        with self.database(path) as db:
            db.execute("PRAGMA user_version = 7")
        self.refuse(3, ["index.sqlite", "format 7", "-o"], *folder)
        with open(path, "wb") as f:
            f.write(b"this is no database" * 500)
        self.refuse(3, ["index.sqlite", "no index"], *folder)

    def test_a_script_that_changes_meanwhile_is_refused(self):
        self.write("part.lua", "return 1")
        self.scenario = self.write("many.lua", MANY + "\nrequire 'part'\n")
        args = ["--vary", "speed=0.4,0.5", "--jobs", 1, *LIGHT]
        self.batch_json("b", *args)
        with self.database(os.path.join(self.path("b"), "index.sqlite")) as db:
            for table in ("run", "timing"):
                db.execute(f"DELETE FROM {table} WHERE run = 1")
        self.write("part.lua", "return 2")
        self.refuse(3, ["part.lua", "was changed"], "batch", self.scenario, "-o", self.path("b"), *args)

    def test_a_script_that_fails_because_it_was_changed_is_no_row(self):
        part = self.write("part.lua", "return 1")
        text = MANY + "\nrequire 'part'\n"
        self.scenario = self.write("many.lua", text)
        args = ["--vary", "speed=0.4,0.5", "--jobs", 1, *LIGHT]

        def is_refused(words):
            self.refuse(3, words, "batch", self.scenario, "-o", self.path("b"), *args)
            with self.database(os.path.join(self.path("b"), "index.sqlite")) as db:
                self.assertEqual(db.execute("SELECT count(*) FROM run").fetchone(), (1,))
        self.batch_json("whole", *args)
        self.batch_json("b", *args)
        with self.database(os.path.join(self.path("b"), "index.sqlite")) as db:
            for table in ("run", "timing"):
                db.execute(f"DELETE FROM {table} WHERE run = 1")
        self.write("part.lua", "error('edited')")
        is_refused(["part.lua", "was changed"])
        os.remove(part)
        is_refused(["part.lua", "is gone"])
        self.write("part.lua", "return 1")
        self.batch_json("b", *args)
        self.assertEqual(self.index("b"), self.index("whole"))

    @unittest.skipIf(SANITIZED, "the sanitizers need file handles of their own")
    def test_want_of_the_system_is_no_answer(self):
        def limit():
            resource.setrlimit(resource.RLIMIT_NOFILE, (12, 12))
        args = ["--vary", "speed=0.4,0.5", "--jobs", 1, *LIGHT]
        done = self.batch("b", *args, preexec_fn=limit)
        self.assertEqual(done.returncode, 5, done.stderr)
        self.assertEqual(self.batch_json("b", *args)["done"], 2)

    def test_a_merge_reads_and_can_be_done_again(self):
        args = ["--vary", "speed=0.4,0.45,0.5", "--repeat", 8, *LIGHT]
        self.batch_json("whole", *args)
        shards = [self.path(f"s{i}") for i in (1, 2)]
        for i, shard in enumerate(shards):
            self.batch_json(shard, *args, "--shard", f"{i + 1}/2")
        before = {shard: sorted(os.listdir(shard)) for shard in shards}

        def limit():
            resource.setrlimit(resource.RLIMIT_FSIZE, (40_000, 40_000))
        merge = ["batch", "merge", self.path("all"), *shards]
        done = self.run_program(*merge, preexec_fn=limit)
        self.assertEqual(done.returncode, 5, done.stderr)
        self.refuse(3, ["'batch merge' did not end here"], "batch", self.scenario, "-o", self.path("all"), *args)
        self.succeed(*merge)
        self.assertEqual(self.index("all"), self.index("whole"))
        self.refuse(3, ["holds a batch already"], *merge)
        self.assertEqual(before, {shard: sorted(os.listdir(shard)) for shard in shards}, "shards are read alone")

    def test_two_batches_in_one_folder(self):
        process = self.start("b", "--vary", "misbehave=hang")
        self.wait_for(lambda: len(children(process.pid)) == 1)
        self.refuse(5, ["another batch writes", "-o"], "batch", self.scenario, "-o", self.path("b"), "--vary",
                    "misbehave=hang")
        process.kill()
        process.communicate()

    def test_a_full_disk_is_exit_5_and_the_folder_goes_on(self):
        def limit():
            resource.setrlimit(resource.RLIMIT_FSIZE, (40_000, 40_000))
        args = ["--vary", "speed=0.4,0.45,0.5", "--repeat", "8", *LIGHT]
        done = self.batch("b", *args, preexec_fn=limit)
        self.assertEqual(done.returncode, 5, done.stderr)
        self.assertIn("cannot be written", done.stderr)
        self.assertIn("index.sqlite", done.stderr)
        self.batch_json("b", *args)
        self.batch_json("c", *args)
        self.assertEqual(self.index("b"), self.index("c"))

    def test_a_disk_that_is_really_full(self):
        """A small tmpfs in a namespace of its own, from too small for the index's first page to one for half of it."""
        if subprocess.run([*ON_A_DISK, "true"], env={**os.environ, "SIZE": "1m", "DISK": self.folder}, check=False,
                          capture_output=True).returncode != 0:
            self.skipTest("may not mount a small tmpfs here: a full disk was not tried")
        os.mkdir(self.path("disk"))
        args = ["batch", self.scenario, "--vary", "speed=0.4,0.45,0.5", "--repeat", "20", *LIGHT]
        self.succeed(*args, "-o", self.path("plain"))
        is_refused = '"$VERISIM" "$@" -o "$DISK/b" && exit 1; test $? = 5 || exit 1; '
        goes_on = is_refused * 2 + ('mount -o remount,size=20m "$DISK"; "$VERISIM" "$@" -o "$DISK/b" --quiet && '
                                    'cp "$DISK/b/index.csv" "$OUT"')
        for size in ("4k", "60k", "100k", "200k"):
            done = subprocess.run([*ON_A_DISK, goes_on, *args], capture_output=True, text=True, check=False, timeout=120,
                                  env={**os.environ, "SIZE": size, "DISK": self.path("disk"), "OUT": self.path("on_disk.csv")})
            self.assertEqual(done.returncode, 0, (size, done.stderr))
            self.assertEqual(done.stderr.count("index.sqlite: cannot be written (database or disk is full); make room"), 2,
                             (size, done.stderr))
            with open(self.path("on_disk.csv"), "rb") as on_disk, open(self.path("plain/index.csv"), "rb") as plain:
                self.assertEqual(on_disk.read(), plain.read(), size)

    def test_a_full_disk_under_run_files_is_no_row(self):
        def limit():
            resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, 100_000))
        args = ["--vary", "speed=0.4,0.5", "--keep", "all"]
        done = self.batch("b", *args, preexec_fn=limit)
        self.assertEqual(done.returncode, 5, done.stderr)
        self.assertEqual(self.batch_json("b", *args)["done"], 2)


if __name__ == "__main__":
    unittest.main()
