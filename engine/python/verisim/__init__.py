"""Verisim from Python: run a scenario, read what it recorded as NumPy arrays, run batches. SI units.

    import verisim
    run = verisim.run("scenarios/peg_in_hole.lua", seed=7, clearance="1mm")
    print(run.summary["outcome"], run["/state/body/pin/pose"].shape)
    table = run.to_pandas()
"""
import json as _json
import os as _os
import warnings as _warnings

from ._verisim import Failure, Frame, version
from ._verisim import RunRequest as _RunRequest
from ._verisim import run as _run
from .batches import Batch, batch
from .run_file import Run
from .values import settings as _settings

__all__ = ["Batch", "Failure", "Frame", "Run", "batch", "run", "version"]
__version__ = version()


def run(scenario, parameters=None, *, seed=None, duration=None, out=None, force=False, binds=None, threads=1,
        prepared=True, each_frame=None, **more):
    """Runs a scenario in this process, with the bits of `verisim run`, and opens its run file.

    out: the run file (default: runs/NAME.h5). binds: {"omni": "reach.csv"}, as --bind. each_frame: called with a Frame
    after every frame, which is over when the call is; False ends the run. parameters and more: the scenario's own,
    numbers or texts with units ("1mm"); one that has the name of a keyword here goes into the dict: {"duration": 2}.
    Failure for bad input, and if the file cannot be written; what the program would warn of, and a run that did not
    come to its end, are a warning and are kept in Run.warnings and Run.error. Ctrl-C ends the run and keeps its file.
    """
    request = _RunRequest()
    request.scenario = _os.fspath(scenario)
    request.parameters = _settings(parameters, more)
    request.binds = [(name, _os.fspath(source)) for name, source in (binds or {}).items()]
    request.seed = seed
    request.duration = duration
    name = _os.path.splitext(_os.path.basename(request.scenario))[0]
    request.out = _os.fspath(out) if out is not None else _os.path.join("runs", name + ".h5")
    request.force = force
    request.threads = threads
    request.prepared = prepared
    outcome = _run(request, each_frame)
    for text in [*outcome.warnings, *([outcome.error] if outcome.error else [])]:
        _warnings.warn(text, RuntimeWarning, stacklevel=2)
    return Run(request.out, figures=_json.loads(outcome.json), warnings=outcome.warnings, error=outcome.error)
