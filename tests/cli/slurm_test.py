"""scenarios/batch/slurm.sh on a real Slurm of one node, from Debian's packages, started here and ended here."""
import getpass
import json
import os
import shutil
import socket
import subprocess
import time
import unittest

from batches import MANY
from program import SOURCE, VERISIM, ProgramTest

PROGRAMS = ["slurmctld", "slurmd", "munged", "sbatch", "squeue"]
MISSING = [name for name in PROGRAMS if shutil.which(name, path=os.environ["PATH"] + ":/usr/sbin") is None]

CONFIG = """
ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ports[0]}
SlurmdPort={ports[1]}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
CredType=cred/munge
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=sched_interval=1,sched_min_interval=1000
CommunicationParameters=NoCtldInAddrAny,NoInAddrAny
ReturnToService=2
MpiDefault=none
NodeName={host} NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN
PartitionName=all Nodes={host} Default=YES State=UP
"""


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for s in sockets:
        s.bind(("127.0.0.1", 0))
    ports = [s.getsockname()[1] for s in sockets]
    for s in sockets:
        s.close()
    return ports


@unittest.skipIf(MISSING, f"not there: {', '.join(MISSING)}; apt install slurmctld slurmd slurm-client munge")
@unittest.skipIf(os.geteuid() != 0, "slurmd wants to be root")
class Slurm(ProgramTest):
    def setUp(self):
        super().setUp()
        os.chmod(self.folder, 0o755)
        self.daemons = []
        self.addCleanup(self.end)
        for name in ("state", "spool"):
            os.mkdir(self.path(name))
        host = socket.gethostname().split(".")[0]
        self.conf = self.write("slurm.conf", CONFIG.format(host=host, folder=self.folder, user=getpass.getuser(),
                                                           ports=free_ports(2)))
        self.env = dict(os.environ, SLURM_CONF=self.conf, PATH=os.environ["PATH"] + ":/usr/sbin", VERISIM=VERISIM)
        key = self.write("munge.key", os.urandom(1024))
        os.chmod(key, 0o400)
        self.start("munged", "--foreground", "--force", f"--socket={self.folder}/munge.socket", f"--key-file={key}",
                   f"--pid-file={self.folder}/munge.pid", f"--log-file={self.folder}/munge.log",
                   f"--seed-file={self.folder}/munge.seed")
        self.wait_or_skip(lambda: os.path.exists(self.path("munge.socket")), "munged")
        self.start("slurmctld", "-D")
        self.start("slurmd", "-D")
        self.wait_or_skip(lambda: "idle" in self.slurm("sinfo", "-h", "-o", "%t").stdout, "Slurm")

    def start(self, *command):
        log = open(self.path(command[0] + ".out"), "w")
        self.addCleanup(log.close)
        self.daemons.append(subprocess.Popen(command, env=self.env, stdout=log, stderr=log, cwd=self.folder))

    def end(self):
        for daemon in reversed(self.daemons):
            daemon.terminate()
        for daemon in self.daemons:
            try:
                daemon.wait(20)
            except subprocess.TimeoutExpired:
                daemon.kill()
                daemon.wait()

    def wait_or_skip(self, what, name):
        begin = time.monotonic()
        while time.monotonic() - begin < 30:
            if what():
                return
            time.sleep(0.2)
        logs = ""
        for log in ("munged.out", "slurmctld.out", "slurmd.out", "slurmctld.log", "slurmd.log"):
            if os.path.exists(self.path(log)):
                with open(self.path(log)) as f:
                    logs += f"\n{log}: " + f.read()[-300:]
        self.skipTest(f"{name} does not start here: {logs}")

    def slurm(self, *command):
        return subprocess.run(command, env=self.env, capture_output=True, text=True, cwd=self.folder)

    def test_shards_on_a_cluster_are_the_batch_of_one_machine(self):
        scenario = self.write("many.lua", MANY)
        design = ["--vary", "speed=0.4,450mm", "--vary", "misbehave=no,error", "--repeat", "3"]
        self.succeed("batch", scenario, "-o", self.path("one"), *design)
        done = subprocess.run([os.path.join(SOURCE, "scenarios", "batch", "slurm.sh"), "3", self.path("many"), scenario,
                               *design], env=dict(self.env, WAIT="1"), capture_output=True, text=True, cwd=self.folder,
                              timeout=300)
        logs = ""
        for name in sorted(os.listdir(self.path("many"))):
            if name.endswith(".log"):
                with open(os.path.join(self.path("many"), name)) as f:
                    logs += f"\n{name}: " + f.read()
        self.assertEqual(done.returncode, 0, done.stderr + logs)
        with open(self.path("one/index.csv"), "rb") as a, open(self.path("many/all/index.csv"), "rb") as b:
            self.assertEqual(a.read(), b.read(), logs)
        again = subprocess.run([os.path.join(SOURCE, "scenarios", "batch", "slurm.sh"), "3", self.path("many"), scenario,
                                *design], env=self.env, capture_output=True, text=True, cwd=self.folder)
        self.assertEqual(again.returncode, 3)
        self.assertIn("is there already", again.stderr)
        with open(self.path("many/all/batch.json")) as f:  # as a merge that was killed leaves it
            manifest = json.load(f)
        with open(self.path("many/all/batch.json"), "w") as f:
            json.dump({**manifest, "merging": True}, f)
        os.remove(self.path("many/all/index.csv"))
        done = subprocess.run([os.path.join(SOURCE, "scenarios", "batch", "slurm.sh"), "3", self.path("many"), scenario,
                               *design], env=dict(self.env, WAIT="1"), capture_output=True, text=True, cwd=self.folder,
                              timeout=300)
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(self.path("one/index.csv"), "rb") as a, open(self.path("many/all/index.csv"), "rb") as b:
            self.assertEqual(a.read(), b.read())


class WithoutSlurm(ProgramTest):
    def test_a_machine_that_submits_no_jobs_is_told_so_and_nothing_is_begun(self):
        os.mkdir(self.path("bin"))
        for name in ("bash", "dirname", "realpath", "mkdir", "sed"):
            os.symlink(shutil.which(name), self.path("bin/" + name))
        done = subprocess.run([os.path.join(SOURCE, "scenarios", "batch", "slurm.sh"), "2", self.path("many"), self.write("many.lua", MANY)],
                              env=dict(os.environ, PATH=self.path("bin"), VERISIM=VERISIM), capture_output=True, text=True, cwd=self.folder)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertRegex(done.stderr, "^error: no sbatch[^\n]+--shard\n$")
        self.assertFalse(os.path.exists(self.path("many")))

    def test_wrong_options_are_told_and_nothing_is_submitted(self):
        os.mkdir(self.path("bin"))
        submits = self.write("bin/sbatch", f"#!/bin/sh\ntouch {self.path('submitted')}\necho 1\n")
        os.chmod(submits, 0o755)
        env = dict(os.environ, PATH=self.path("bin") + ":" + os.environ["PATH"], VERISIM=VERISIM)
        scenario = self.write("many.lua", MANY)
        for code, words, options in ((2, "--vry", ["--vry", "speed=1"]), (3, "no parameter 'sped'", ["--vary", "sped=1"]),
                                     (2, "--repeat", ["--repeat", "0"]), (0, "", ["--vary", "speed=1"])):
            done = subprocess.run([os.path.join(SOURCE, "scenarios", "batch", "slurm.sh"), "2", self.path("many"), scenario, *options],
                                  env=env, capture_output=True, text=True, cwd=self.folder)
            self.assertEqual(done.returncode, code, done.stderr)
            self.assertIn(words, done.stderr)
            self.assertEqual(os.path.exists(self.path("many")), code == 0)
            self.assertEqual(os.path.exists(self.path("submitted")), code == 0)


if __name__ == "__main__":
    unittest.main()
