"""README shows what the program prints now: what no clock has a part in, to the letter."""
import os
import re
import unittest

import readme
from program import ProgramTest, SOURCE


def text():
    with open(os.path.join(SOURCE, "README.md"), encoding="utf-8") as f:
        return f.read()


class Readme(ProgramTest):
    def test_the_batch_has_the_figures_that_it_shows(self):
        shown = readme.shown(text(), readme.BATCH)
        printed = self.succeed(*readme.command(text(), readme.BATCH, SOURCE, self.path("pins"))).stdout.strip().splitlines()
        self.assertEqual(printed[1:], shown[2:])  # the first line names the folder

    def test_the_trade_off_has_the_errors_that_it_shows(self):
        shown = readme.shown(text(), readme.TRADE_OFF)
        printed = self.succeed(*readme.command(text(), readme.TRADE_OFF, SOURCE, self.path("trade"))).stdout.strip().splitlines()
        self.assertEqual(printed[:2], shown[1:3], "the truth, and what is known of it")
        names = ["#", "hybrid", "voxelsize", "frame, us", "from", "to", "us per ms", "force, N"]
        self.assertEqual(re.split("  +", shown[3].strip())[:len(names)], re.split("  +", "  ".join(names)))

        def computed(lines):  # columns 3 to 6 are times, and what is dominated hangs on them
            rows = [line.split() for line in lines if re.match(r"  \d  ", line)]
            return [row[:3] + row[7:14] for row in rows]
        self.assertEqual(len(computed(shown)), 6)
        self.assertEqual(computed(printed), computed(shown))

    def test_the_ledgers_have_the_figures_that_it_shows(self):
        shown = readme.LEDGERS.search(text())[2].splitlines()
        printed = self.succeed("stability", "--only", "ledgers").stdout.splitlines()
        for line in shown[1:]:
            begin = line.split("…")[0].split()
            self.assertIn(begin, [other.split()[:len(begin)] for other in printed], line)


if __name__ == "__main__":
    unittest.main()
