"""Damaged run files: closed ones, one that was killed, one of a run that was interrupted.

`recover` and `replay --verify` refuse each in one line or do what they say. The ruler is h5py: a file that verifies holds
every value and attribute of the undamaged one; a file that `recover` cannot close it leaves as it was, to the byte; what it
closes h5py reads, all of it.
"""
import os
import signal
import subprocess
import sys
import tempfile
import time

import h5py
import numpy

import damage
import hostile

sys.path.insert(0, os.path.join(hostile.SOURCE, "tests", "cli"))
from program import SMALL  # noqa: E402

SECONDS = 60  # of the wall clock: other work may have the processor
SMALL_SCENE = SMALL.replace("duration = 0.3", "duration = 0.06")
HEADS = SMALL_SCENE + '\nWiiHead{ name = "one", tracker = "geometric" }\n'
EXACT = SMALL_SCENE.replace("{ duration = p.duration }", '{ duration = p.duration, hybrid = "exact" }')


def values(path):
    """Every dataset and attribute, as bytes or text."""
    with h5py.File(path, "r") as f:
        found = {}

        def keep(name, o):
            for attribute in o.attrs:
                found[f"{name}@{attribute}"] = numpy.asarray(o.attrs[attribute]).astype(object).tolist()
            if isinstance(o, h5py.Dataset):
                found[name] = (str(o.dtype), o.shape, numpy.asarray(o[()]).tobytes())
        keep("/", f["/"])
        f.visititems(keep)
        return found


class RunFile:
    """`killed`: nothing in it was under a checksum yet. What a simulation computes again is held against it all the same."""
    def __init__(self, content, folder, killed):
        self.content, self.killed = content, killed
        path = os.path.join(folder, "closed.h5")
        with open(path, "wb") as f:
            f.write(content)
        subprocess.run([hostile.VERISIM, "recover", path], check=True, capture_output=True)
        self.values = values(path)


def run_files():
    found = []
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "run.h5")

        def write(script):
            with open(os.path.join(folder, "scene.lua"), "w") as f:
                f.write(script)

        def keep(killed=False):
            with open(path, "rb") as f:
                found.append(RunFile(f.read(), folder, killed))
            os.remove(path)
        for script in (SMALL_SCENE, HEADS, EXACT):
            write(script)
            subprocess.run([hostile.VERISIM, "run", "scene.lua", "-o", "run.h5", "--quiet"], cwd=folder, check=True)
            keep()
        write(SMALL_SCENE)
        for end in (signal.SIGINT, signal.SIGKILL):
            process = subprocess.Popen([hostile.VERISIM, "run", "scene.lua", "-o", "run.h5", "--quiet", "--realtime", "--duration",
                                        "100"], cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            while not os.path.exists(path):
                time.sleep(0.002)
            time.sleep(0.1)
            process.send_signal(end)
            process.wait()
            keep(killed=end == signal.SIGKILL)
    return found


RUN_FILES = run_files()


def in_another_process(what):
    """HDF5 may crash on a damaged file, in h5py as anywhere; what is judged here is the program, not h5py."""
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        text = b""
        try:
            os.close(reader)
            os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
            text = what().encode(errors="replace")
        except Exception as error:
            text = f"h5py: {error!r}".encode(errors="replace")
        finally:
            os.write(writer, text[:4000])
            os._exit(0)
    os.close(writer)
    with os.fdopen(reader, "rb") as f:
        text = f.read().decode()
    status = os.waitpid(child, 0)[1]
    return text if status == 0 else f"h5py ended with status {status}"


def is_kept(undamaged, name, value):
    """A killed file that lost its end is one that was killed earlier."""
    whole = undamaged.values[name]
    if value != whole and undamaged.killed and isinstance(value, tuple) and "@" not in name:
        return value[0] == whole[0] and value[1][1:] == whole[1][1:] and whole[2].startswith(value[2])
    return value == whole


def difference(undamaged, path):
    """Empty, or what another file than the undamaged one would have."""
    found = values(path)
    different = [name for name in undamaged.values if not is_kept(undamaged, name, found.get(name))]
    different += [name for name in found if name not in undamaged.values]
    if undamaged.killed:
        once = ("/@checksums", "timing/", "inputs/models/")
        different = [name for name in different if not name.startswith(once) and not name.endswith(("@units", "@description"))]
    return ", ".join(different[:5])


def one(draw, folder):
    undamaged = draw.choice(RUN_FILES)
    path = os.path.join(folder, "run.h5")
    content = damage.damaged(draw, undamaged.content)
    with open(path, "wb") as f:
        f.write(content)
    if draw.random() < 0.4:
        return recovered(folder, path, content)
    command = draw.choice([["--verify"], ["--verify"], ["--verify", "--json"], []])
    done = hostile.attempt(folder, ["replay", "run.h5", *command], SECONDS, {0, 1, 3, 4})
    if done.code != 0:
        return f"replay: {({1: 'differs', 3: 'refused', 4: 'diverges'})[done.code]}"
    if "--json" in command:
        hostile.strict_json(done)
    if not command:
        return "replay: replayed"
    if b"notice: " in done.err and b"another" in done.err:
        return "replay: verified with a notice"
    text = in_another_process(lambda: difference(undamaged, path))
    if text:
        raise hostile.Broken(f"verified, but not as it was written: {text}\n{done.err.decode()}")
    return "replay: verified, and nothing is different"


def recovered(folder, path, content):
    done = hostile.attempt(folder, ["recover", "run.h5"], SECONDS, {0, 3})
    with open(path, "rb") as f:
        after = f.read()
    if sorted(os.listdir(folder)) != ["run.h5"]:
        raise hostile.Broken(f"recover leaves {os.listdir(folder)}")
    if done.code == 3:
        if after != content:
            raise hostile.Broken("refused by recover, but changed")
        return "recover: refused"
    if b"nothing to do" in done.out:
        if after != content:
            raise hostile.Broken("nothing to do, but changed")
        return "recover: closed already"
    text = in_another_process(lambda: "" if values(path) else "is empty")
    if text:
        raise hostile.Broken(f"recovered, but: {text}")
    hostile.attempt(folder, ["replay", "run.h5", "--verify"], SECONDS, {0, 1, 3, 4})
    return "recover: closed"


if __name__ == "__main__":
    hostile.main(one)
