"""How much of a run is missing that was killed (INTERFACES section 2). Alone: it is judged by the clock."""
import time
import unittest

import h5py

from killable import Killable


class KilledInTime(Killable):
    def test_at_most_a_tenth_of_a_second_is_missing(self):
        """Paced, so that the clock says how many frames there were."""
        process, run_file = self.start("--realtime")
        start = time.time()
        time.sleep(1.5)
        process.kill()
        lived = time.time() - start
        process.communicate()
        self.succeed("recover", run_file)
        with h5py.File(run_file, "r") as f:
            # 100 ms that may be missing, and as much again for a machine that schedules badly.
            self.assertGreater(f["/state/time"][-1], lived - 0.2)


if __name__ == "__main__":
    unittest.main()
