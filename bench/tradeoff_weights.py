"""What a count of /cost costs: fits ns to the settings of tables that `verisim tradeoff -o FOLDER` wrote.

    tradeoff_weights.py FOLDER/tradeoff.json ...

Mean frame times, each divided by itself (a factor is an error, whatever the scene's size); weights that would be
negative are 0. engine/tradeoff/table.cpp holds what it printed.
"""
import json
import sys

import numpy as np

COUNTERS = ["links", "points_tested", "contacts", "lookups", "exact_samples", "solver_steps"]


def fit(paths):
    counts, times = [], []
    for path in paths:
        with open(path) as f:
            rows = json.load(f)["rows"]
        for row in (r for r in rows if "failed" not in r):
            counts.append([1] + [row["cost"][name] / row["frames"] for name in COUNTERS])
            times.append(1000 * row["mean_us"])
    relative = np.array(counts) / np.array(times)[:, None]
    used = list(range(len(COUNTERS) + 1))
    while True:  # the most negative goes first
        weights = np.linalg.lstsq(relative[:, used], np.ones(len(times)), rcond=None)[0]
        if (weights >= 0).all():
            break
        used.pop(int(np.argmin(weights)))
    ratios = relative[:, used] @ weights
    print(f"{len(times)} settings, rms of the relative error {np.sqrt(np.mean((ratios - 1) ** 2)):.2f}, "
          f"counted by measured {ratios.min():.2f} to {ratios.max():.2f}")
    for i, weight in zip(used, weights):
        print(f"{(['frame'] + COUNTERS)[i]:<16}{weight:10.1f} ns")


if __name__ == "__main__":
    fit(sys.argv[1:])
