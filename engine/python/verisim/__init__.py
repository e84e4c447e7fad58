"""Verisim from Python: run a scenario, read what it recorded as NumPy arrays, run batches. SI units.

    import verisim
    run = verisim.run("scenarios/peg_in_hole.lua", seed=7, clearance="1mm")
    print(run.summary["outcome"], run["/state/body/pin/pose"].shape)
    table = run.to_pandas()
"""
import contextlib as _contextlib
import json as _json
import os as _os
import threading as _threading
import warnings as _warnings

from ._verisim import Failure, Frame, version
from ._verisim import RunRequest as _RunRequest
from ._verisim import run as _run
from .batches import Batch, batch
from .run_file import Run
from . import values as _values

__all__ = ["Batch", "Failure", "Frame", "Run", "batch", "run", "version"]
__version__ = version()


def run(scenario, parameters=None, *, seed=None, duration=None, out=None, force=False, binds=None, threads=1,
        prepared=True, each_frame=None, **more):
    """Runs a scenario in this process, with the bits of `verisim run`, and opens its run file.

    out: the run file (default: runs/NAME.h5, or runs/NAME-2.h5 … while another run has that; Run.path says which).
    binds: {"omni": "reach.csv"}, as --bind. each_frame: called with a Frame after every frame, which is over when the
    call is; False ends the run. parameters and more: the scenario's own, numbers or texts with units ("1mm"); one that
    has the name of a keyword here goes into the dict: {"duration": 2}. Failure for bad input, a value of another kind
    among it, and if the file cannot be written; ValueError for a path, name or text that has a NUL character or is not UTF-8; what the program would warn
    of, and a run that did not come to its end, are warnings and are kept in Run.warnings and Run.error. Ctrl-C ends
    the run and keeps its file.
    """
    request = _RunRequest()
    request.scenario = _values.path_of("scenario", scenario)
    request.parameters = _values.settings(parameters, more)
    request.binds = [(_values.line_of("the name of a bind", name), _values.path_of(f"bind {name}", source))
                     for name, source in _values.items_of("binds", binds)]
    request.seed = None if seed is None else _values.seed_of(seed)
    request.duration = None if duration is None else _values.seconds_of("duration", duration)
    request.force = _values.flag_of("force", force)
    request.threads = _values.whole_of("threads", threads, 1, 256)
    request.prepared = _values.flag_of("prepared", prepared)
    if each_frame is not None and not callable(each_frame):
        raise Failure(f"each_frame: {_values.shown(each_frame)} cannot be called; give a function that takes a Frame")
    if out is None:
        with _default_out(request.scenario) as request.out:
            request.another_name = True
            run = _run_and_open(request, each_frame)
    else:
        request.out = _values.path_of("out", out)
        if not request.out:
            raise Failure("out: is empty; name a run file, or leave it out for runs/NAME.h5")
        run = _run_and_open(request, each_frame)
    for text in [*run.warnings, *([run.error] if run.error else [])]:
        _warnings.warn(text, RuntimeWarning, stacklevel=2)
    return run


def _run_and_open(request, each_frame):
    outcome = _run(request, each_frame)
    return Run(outcome.out, figures=_json.loads(outcome.json), warnings=outcome.warnings, error=outcome.error)


_default_outs, _default_outs_lock = set(), _threading.Lock()


@_contextlib.contextmanager
def _default_out(scenario):
    """runs/NAME.h5, or runs/NAME-2.h5 … while other threads have that: each has its own until it has opened what it wrote.
    (What other processes write is seen when the file is made: another_name.)"""
    stem = _os.path.join("runs", _os.path.splitext(_os.path.basename(scenario))[0])
    with _default_outs_lock:
        out, n = stem + ".h5", 1
        while out in _default_outs:
            n += 1
            out = f"{stem}-{n}.h5"
        _default_outs.add(out)
    try:
        yield out
    finally:
        with _default_outs_lock:
            _default_outs.discard(out)
