"""The work that shipped scenarios take, counted: counts.py PROGRAM [--update] [--file FILE].

Runs what bench/baseline/counts.json lists and compares the sums of /cost, frames and outcome with what stands there. Counts
are the same on every machine: one that differs is a change of the program. Exit 1 with the list of them; --update writes the
file anew. ctest calls this (label `counts`), and `cmake --build build --target update_counts` updates.
"""
import argparse
import json
import os
import subprocess
import sys
import tempfile

import h5py

HERE = os.path.dirname(os.path.abspath(__file__))
SCENARIOS = os.path.join(HERE, "..", "..", "scenarios")
UPDATE = "cmake --build build --target update_counts"


def listed(file):
    """The runs of the file, each a dict with `run` and `cost`."""
    advice = f"put the committed file back, then {UPDATE}"
    try:
        with open(file) as f:
            runs = json.load(f)["runs"]
    except OSError as error:
        sys.exit(f"error: {file}: cannot be read ({error.strerror}); {advice}")
    except json.JSONDecodeError as error:
        sys.exit(f"error: {file}:{error.lineno}: is no JSON ({error.msg}); {advice}")
    except (KeyError, TypeError):
        runs = None
    if not isinstance(runs, list):
        sys.exit(f"error: {file}: has no list 'runs'; {advice}")
    for i, run in enumerate(runs):
        if not isinstance(run, dict) or not isinstance(run.get("run"), str) or not isinstance(run.get("cost"), dict):
            sys.exit(f"error: {file}: runs[{i}] is not what this program writes (`run`, `cost` …); {advice}")
    return runs


def measured(program, run):
    """Frames, outcome, state hash and the sums of /cost of one run."""
    with tempfile.TemporaryDirectory() as folder:
        file = os.path.join(folder, "run.h5")
        scenario, *options = run.split()
        done = subprocess.run([program, "run", os.path.join(SCENARIOS, scenario), *options, "-o", file, "--json"],
                              capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit(f"{run}: ended with {done.returncode}: {done.stderr.strip()}")
        summary = json.loads(done.stdout)
        with h5py.File(file) as f:
            costs = {}
            f["cost"].visititems(lambda name, node: costs.update({name: int(node[()].sum())})
                                 if isinstance(node, h5py.Dataset) else None)
    return {"run": run, "outcome": summary["outcome"], "frames": summary["frames"],
            "collision_frames": summary["collision_frames"], "cost": dict(sorted(costs.items()))}


def differences(wanted, found):
    flat = [{**{k: v for k, v in of.items() if k != "cost"}, **of["cost"]} for of in (wanted, found)]
    names = list(dict.fromkeys([*flat[0], *flat[1]]))
    return [(name, flat[0].get(name, "-"), flat[1].get(name, "-")) for name in names
            if flat[0].get(name) != flat[1].get(name)]


def text_of(runs):
    """A line for each count: a change of one is a line of a diff."""
    return json.dumps({"runs": runs}, indent=1) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program")
    parser.add_argument("--update", action="store_true")
    parser.add_argument("--file", default=os.path.join(HERE, "counts.json"))
    asked = parser.parse_args()
    wanted = listed(asked.file)
    found = [measured(asked.program, run["run"]) for run in wanted]
    if asked.update:
        with open(asked.file, "w") as f:
            f.write(text_of(found))
        print(f"{asked.file}: {len(found)} runs written")
        return 0
    rows = [(a["run"], *row) for a, b in zip(wanted, found) for row in differences(a, b)]
    for run in dict.fromkeys(row[0] for row in rows):
        print(run)
        for _, name, before, now in (row for row in rows if row[0] == run):
            more = f"{100 * (now - before) / before:+.3g} %" if isinstance(before, int) and isinstance(now, int) and before else ""
            print(f"  {name:<20} {before!s:>14} -> {now!s:>14}  {more}")
    if rows:
        print(f"\n{len(rows)} counts differ from {os.path.relpath(asked.file)}. If this is what the change is for, update"
              f" the file in the same commit:\n  {UPDATE}")
    else:
        print(f"{len(found)} runs: every count is as in {os.path.relpath(asked.file)}")
    return 1 if rows else 0


if __name__ == "__main__":
    sys.exit(main())
