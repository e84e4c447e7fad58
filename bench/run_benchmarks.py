"""Runs the benchmark suites and writes one JSON file: run_benchmarks.py FOLDER OUT.json KEY=VALUE... [-- PROGRAM...].

FOLDER holds the programs whose names end in _bench. Each repeats its benchmarks in an order that is drawn
(--benchmark_enable_random_interleaving), without aggregates, which `verisim compare A.json B.json` makes itself. KEY=VALUE
stands in the file's context, beside commit, CPU and governor. VERISIM_BENCH_REPETITIONS (20) and
VERISIM_BENCH_FILTER (a regular expression) choose. Target `bench` calls this: cmake --build --preset bench.
"""
import json
import os
import pathlib
import subprocess
import sys
import tempfile


def text_of(path, otherwise):
    try:
        return pathlib.Path(path).read_text().strip()
    except OSError:
        return otherwise


def cpu():
    lines = text_of("/proc/cpuinfo", "").splitlines()
    return next((line.split(": ")[1] for line in lines if line.startswith("model name")), "unknown")


def commit(source):
    done = subprocess.run(["git", "-C", source, "describe", "--always", "--dirty", "--abbrev=12", "--exclude=*"],
                          capture_output=True, text=True)
    return done.stdout.strip() if done.returncode == 0 else "unknown"


def main():
    folder, out, *context = sys.argv[1:]
    context = dict(pair.split("=", 1) for pair in context)
    if context.get("build_type") != "Release":
        sys.exit(f"error: the build type is '{context.get('build_type')}': times of a build that is not optimised tell "
                 "nothing; use cmake --preset bench")
    context["commit"] = commit(str(pathlib.Path(__file__).parent))
    context["cpu"] = cpu()
    context["governor"] = text_of("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", "none to be seen")
    programs = sorted(p for p in pathlib.Path(folder).iterdir() if p.name.endswith("_bench") and os.access(p, os.X_OK))
    whole, missed = {"context": {}, "benchmarks": []}, []
    for program in programs:
        print(f"{program.name} ...", flush=True)
        with tempfile.TemporaryDirectory() as work:
            part = pathlib.Path(work) / "part.json"
            done = subprocess.run([program, f"--benchmark_out={part}", "--benchmark_out_format=json",
                                   f"--benchmark_repetitions={os.environ.get('VERISIM_BENCH_REPETITIONS', '20')}",
                                   f"--benchmark_filter={os.environ.get('VERISIM_BENCH_FILTER', '.')}",
                                   "--benchmark_min_time=0.05", "--benchmark_enable_random_interleaving=true",
                                   "--benchmark_report_aggregates_only=false"],
                                  stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
            if done.returncode != 0:
                missed += [line for line in done.stderr.splitlines() if line.startswith("MISSED")] or [program.name]
            text = part.read_text() if part.exists() else ""
            if not text:  # the filter chose none of this program's
                continue
            result = json.loads(text)
        whole["context"] = whole["context"] or result["context"]
        whole["benchmarks"] += [row for row in result["benchmarks"] if row.get("run_type") != "aggregate"]
    if not whole["benchmarks"] and not missed:
        sys.exit(f"error: no benchmark's name has VERISIM_BENCH_FILTER={os.environ.get('VERISIM_BENCH_FILTER', '.')} in it; {out} is not written")
    whole["context"].update(context)
    pathlib.Path(out).write_text(json.dumps(whole, indent=1) + "\n")
    names = {row["run_name"] for row in whole["benchmarks"]}
    print(f"{out}: {len(names)} benchmarks of {len(programs)} programs at commit {context['commit']}")
    for line in missed:
        print(f"a promise was missed or an answer wrong: {line}")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
