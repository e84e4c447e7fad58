"""What the fuzzers of files and of command lines share: they start the program as users do and hold it to what it promises.

Of every attempt: it ends by itself, in time and within its memory, by none of the system's signals; the exit code is one of
those that INTERFACES section 1 has for it; stderr is lines of text, of which one, and only if it failed, is the error; with
an error nothing on stdout looks like a result.
"""
import collections
import concurrent.futures
import itertools
import json
import math
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time

VERISIM = os.environ["VERISIM"]
SOURCE = os.environ["VERISIM_SOURCE_DIR"]
SHARED = os.environ["VERISIM_SHARED_DATA"]
SANITIZED = os.environ.get("VERISIM_SANITIZE", "") != ""
SLOWER = 10 if SANITIZED else 1  # a program of the sanitizers
MEMORY_MAX = 2 << 30  # bytes, of one process; the sanitizers' shadow memory is no measure
BROKEN_MAX = 10  # then the search ends


class Broken(Exception):
    """A promise that was not kept."""


class Done:
    def __init__(self, args, code, out, err, seconds):
        self.args, self.code, self.out, self.err, self.seconds = args, code, out, err, seconds


def attempt(folder, args, seconds, codes, interrupted=None):
    """Runs the program; what it did, if all promises were kept. `interrupted`: seconds after which Ctrl-C is pressed."""
    begin = time.monotonic()
    process = subprocess.Popen([VERISIM, *args], cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE)
    try:
        if interrupted is not None:
            try:
                out, err = process.communicate(timeout=interrupted * SLOWER)
            except subprocess.TimeoutExpired:
                process.send_signal(signal.SIGINT)
                codes = {*codes, 130}
                out, err = process.communicate(timeout=seconds * SLOWER)
        else:
            out, err = process.communicate(timeout=seconds * SLOWER)
    except subprocess.TimeoutExpired:
        process.kill()
        out, err = process.communicate()
        raise Broken(f"{args}: did not end in {seconds * SLOWER} s") from None
    done = Done(args, process.returncode, out, err, time.monotonic() - begin)
    hold_to_promises(done, codes)
    return done


def hold_to_promises(done, codes):
    shown = f"{done.args}: exit code {done.code}\n{done.err[-2000:].decode(errors='replace')}"
    if done.code not in codes:
        raise Broken(f"promised are {sorted(codes)}; {shown}")
    try:
        lines = done.err.decode().splitlines()
        done.out.decode()
    except UnicodeDecodeError:
        raise Broken("not UTF-8: " + shown) from None
    if any(ord(c) < 32 and c not in "\n\t" for c in done.err.decode()):
        raise Broken("a control character: " + shown)
    errors = [line for line in lines if line.startswith("error: ")]
    if len(errors) not in {0: [0], 130: [0, 1]}.get(done.code, [1]):
        raise Broken(f"{len(errors)} errors: {shown}")
    some_runs_undone = done.args[:1] == ["batch"] and done.code == 1  # the other runs are a result
    if done.code not in (0, 130) and done.out and not some_runs_undone:
        raise Broken("looks like a result: " + shown)
    if not SANITIZED and resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024 > MEMORY_MAX:
        raise Broken("took more than 2 GiB of memory: " + shown)


def strict_json(done):
    """The one object on stdout, with finite numbers and no name twice."""
    def no_constant(name):
        raise Broken(f"{done.args}: {name} in JSON")

    def once(pairs):
        if len({name for name, _ in pairs}) != len(pairs):
            raise Broken(f"{done.args}: a name twice in JSON")
        return dict(pairs)
    try:
        found = json.loads(done.out, parse_constant=no_constant, object_pairs_hook=once)
    except ValueError as error:
        raise Broken(f"{done.args}: {error}") from None
    numbers = [found]
    while numbers:
        value = numbers.pop()
        numbers.extend(value.values() if isinstance(value, dict) else value if isinstance(value, list) else [])
        if isinstance(value, float) and not math.isfinite(value):
            raise Broken(f"{done.args}: a number that is not finite in JSON")
    return found


def in_a_folder(one, seed):
    """How the input of this seed ended, and what was broken. The folder of a broken one is kept."""
    folder = tempfile.mkdtemp(prefix=f"verisim-hostile-{seed}-")
    try:
        kind, broken = one(random.Random(seed), folder), None
    except Broken as error:
        return "BROKEN", f"seed {seed}: {error}\n  the files are kept in {folder}"
    shutil.rmtree(folder, ignore_errors=True)
    return kind, broken


def main(one):
    """NAME.py SHORT LONG [FIRST_SEED]. one(draw, folder): how it ended, or Broken."""
    short, long, first = (list(map(int, sys.argv[1:])) + [1])[:3]
    is_long = os.environ.get("VERISIM_LONG_TESTS") == "1"
    count = long if is_long else max(1, short // (4 if SANITIZED else 1))
    kinds, broken, begin = collections.Counter(), [], time.monotonic()
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count() if is_long else 1) as pool:
        seeds = iter(range(first, first + count))
        waiting = {pool.submit(in_a_folder, one, seed) for seed in itertools.islice(seeds, 8)}
        while waiting:
            ended, waiting = concurrent.futures.wait(waiting, return_when=concurrent.futures.FIRST_COMPLETED)
            for future in ended:
                kind, text = future.result()
                kinds[kind] += 1
                if text:
                    print(text, flush=True)
                    broken.append(text)
                if is_long and sum(kinds.values()) % 1000 == 0:
                    print(f"{sum(kinds.values())} of {count}, {time.monotonic() - begin:.0f} s", flush=True)
                if len(broken) < BROKEN_MAX:
                    waiting |= {pool.submit(in_a_folder, one, seed) for seed in itertools.islice(seeds, 1)}
    for kind, number in sorted(kinds.items()):
        print(f"{kind:40}{number:8}")
    largest = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024
    print(f"{time.monotonic() - begin:.0f} s, at most {largest / 1e6:.0f} MB of memory")
    sys.exit(1 if broken else 0)
