"""Batches, by the program: a run is a process of its own, and what it does to itself is a row."""
import json
import os
import shutil
import signal
import sqlite3
import subprocess
import urllib.parse
import warnings

from ._verisim import Failure
from .values import flag_of, items_of, line_of, list_of, path_of, seconds_of, seed_of, settings, shown, whole_of


class Batch:
    """The folder of a batch. groups: outcomes and measures with their intervals."""

    def __init__(self, folder):
        self.folder = path_of("folder", folder)
        self._index = os.path.join(self.folder, "index.sqlite")
        if not os.path.exists(self._index):
            raise Failure(f"{self.folder}: holds no batch; name a folder of verisim batch")
        self.report = None

    groups = property(lambda self: self.report["groups"] if self.report else None)

    def rows(self, query="SELECT * FROM run ORDER BY run"):
        """A dict per run, or what else the query asks for (tables run, timing, unit)."""
        # With a log beside it somebody may be writing; without one nothing need be written to read.
        mode = "mode=ro" if os.path.exists(self._index + "-wal") else "mode=ro&immutable=1"
        database = sqlite3.connect(f"file:{urllib.parse.quote(self._index)}?{mode}", uri=True)
        try:
            database.row_factory = sqlite3.Row
            return [dict(row) for row in database.execute(query)]
        except sqlite3.DatabaseError as error:
            raise Failure(f"{self._index}: {error}; look at the query, or make the batch again in another folder") from error
        finally:
            database.close()

    def to_pandas(self):
        """A DataFrame with a row per run."""
        import pandas

        return pandas.DataFrame(self.rows()).set_index("run")


def batch(scenario, out, parameters=None, *, vary=None, repeat=1, seed=None, design=None, random=None, jobs=None, duration=None,
          measure=False, keep="summary", time_limit=None, memory_limit=None, retry_failed=False, binds=None, **more):
    """Runs many: vary={"clearance": ["1mm", "0.1mm"]} is a grid, random=(1000, {"clearance": "1mm..5mm"}) draws, design
    a CSV file. parameters and more: as in run(). Goes on where a batch in the folder `out` stopped; retry_failed does
    again what was killed, crashed, or had too little time [s] or memory [MiB]. Failure as the
    program says it; a run that could not be done is a row, and a warning says how many there are. ValueError: as of run()."""
    out = path_of("out", out)
    if not out:
        raise Failure("out: is empty; name a folder")
    arguments = ["batch", path_of("scenario", scenario), "-o", out, "--json", "--repeat",
                 str(whole_of("repeat", repeat, 1, 10_000_000)), "--keep", line_of("keep", keep)]
    for key, values in items_of("vary", vary):
        arguments += ["--vary", f"{line_of('the name of what varies', key)}={list_of(key, values)}"]
    for key, text in settings(parameters, more):
        arguments += ["--set", f"{key}={text}"]
    for name, source in items_of("binds", binds):
        arguments += ["--bind", f"{line_of('the name of a bind', name)}={path_of(f'bind {name}', source)}"]
    for option, value, text_of in (("--seed", seed, seed_of), ("--design", design, lambda v: path_of("design", v)),
                                   ("--jobs", jobs, lambda v: whole_of("jobs", v, 1, 4096)),
                                   ("--duration", duration, lambda v: seconds_of("duration", v)),
                                   ("--time-limit", time_limit, lambda v: seconds_of("time_limit", v)),
                                   ("--memory-limit", memory_limit, lambda v: whole_of("memory_limit", v, 1, 1 << 30))):
        if value is not None:
            arguments += [option, str(text_of(value))]
    if flag_of("measure", measure):
        arguments.append("--measure")
    if flag_of("retry_failed", retry_failed):
        arguments.append("--retry-failed")
    if random is not None:
        arguments += ["--random", *_draws(random)]
    exit_code, printed, said = _ended([_program(), *arguments])
    lines = said.strip().splitlines()
    if exit_code not in (0, 1) or not printed:
        raise Failure(lines[-1].removeprefix("error: ") if lines else f"verisim ended with {exit_code}")
    for line in lines:
        warnings.warn(line.removeprefix("warning: ").removeprefix("error: "), RuntimeWarning, stacklevel=2)
    made = Batch(out)
    made.report = json.loads(printed)
    return made


def _draws(random):
    if not isinstance(random, (tuple, list)) or len(random) != 2:
        raise Failure(f'random: {shown(random)} is no number of draws with a dict; give (1000, {{"clearance": "1mm..5mm"}})')
    draws, keys = random
    return [str(whole_of("random", draws, 0, 10_000_000)), *(line_of("random", f"{key}={text}") for key, text in items_of("random", keys))]


def _ended(command):
    """What it ended with and printed. Ctrl-C lets it end its workers and keep its rows."""
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        printed, said = process.communicate()
    except BaseException:
        process.send_signal(signal.SIGINT)
        process.wait()
        raise
    return process.returncode, printed, said


def _program():
    """As it was built or installed with this module, else the one on the path."""
    here = os.path.dirname(os.path.abspath(__file__))
    above = [os.path.normpath(os.path.join(here, *[".."] * n)) for n in (2, 4)]  # build/python/verisim; lib/python3/…
    for program in (os.path.join(above[0], "verisim"), os.path.join(above[1], "bin", "verisim")):
        if os.access(program, os.X_OK) and os.path.isfile(program):
            return program
    program = shutil.which("verisim")
    if program is None:
        raise Failure("the program verisim is neither beside this module nor on the path; install it")
    return program
