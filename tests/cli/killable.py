"""What the tests of killed runs share: a run that goes on until it is killed."""
import os
import subprocess
import time

from program import ProgramTest, SMALL, VERISIM


class Killable(ProgramTest):
    def start(self, *options):
        scenario = self.write("small.lua", SMALL)
        run_file = self.path("killed.h5")
        if os.path.exists(run_file):
            os.remove(run_file)
        args = [VERISIM, "run", scenario, "-o", run_file, "--duration", "600", *options]
        process = subprocess.Popen(args, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=self.folder)
        deadline = time.time() + 60
        while not os.path.exists(run_file):
            self.assertIsNone(process.poll(), "ended by itself")
            self.assertLess(time.time(), deadline)
            time.sleep(0.002)
        return process, run_file
