"""Command lines: the options that `--help` of each command names, with values that nobody sane would give.

Each ends with one of the promised exit codes; files in its folder that it may not replace are there afterwards, to the byte.
What takes long is interrupted, and ends then.
"""
import hashlib
import os
import re
import subprocess
import sys

import hostile

sys.path.insert(0, os.path.join(hostile.SOURCE, "tests", "cli"))
from program import SMALL, turned_stl  # noqa: E402
from traces import as_csv  # noqa: E402

SECONDS = 60
PATIENCE = 3  # s, before Ctrl-C
COMMANDS = [[], ["run"], ["run"], ["run"], ["replay"], ["recover"], ["inspect"], ["trace"], ["trace", "info"], ["trace", "convert"],
            ["trace", "synth"], ["wii"], ["wii", "validate"], ["wii", "place"], ["wii", "track"], ["wii", "serve"],
            ["wii", "listen"], ["reproduce"], ["compare"], ["doctor"], ["batch"], ["batch"], ["batch", "merge"]]
FILES = ["scene.lua", "hand.csv", "wii.csv", "part.stl", "run.h5", "notes.txt", "folder", "loop", "no_such_file"]
VALUES = ["", " ", "-", "--", "-1", "0", "1", "2", "256", "257", "0.01", "1e-300", "1e300", "-0", "nan", "inf", "18446744073709551615",
          "18446744073709551616", "0x10", "1e3", "x", "a=b", "=", "duration=0.01", "speed=1e9", "word='a\nb'", "voxelsize=0/0",
          "word=('x'):rep(1e9)", "speed=(function() while true do end end)()", "hand=hand.csv", "hand=", "=hand.csv",
          "hand=/dev/zero", "/dev/null", "/dev/zero", "/dev/stdin", "/", ".", "..", "/proc/self/mem", "/no/such/folder/x.h5",
          "x" * 300, "x" * 100_000, "\udcff", "\udc80.h5", "\x1b[31m", "%s%n%d", "$(id)", "ä", "a\tb", "out.h5", "out.csv", "out.html",
          "scalar", "AVX2", "scaat", "geometric", "stereo", "sweep-x", "ideal", "haptic", "insertion", "px=x_m*2", "px=:1", "px=99",
          "WiiMote0@localhost:1", "0 0 0", "43", "localhost", "0.0.0.0", "R1"]

USUAL = {"run": ["scene.lua"], "replay": ["run.h5"], "recover": ["run.h5"], "inspect": ["part.stl", "part.step"],
         "batch": ["scene.lua"], "compare": ["run.h5"], "merge": ["pins", "folder"], "--vary": ["speed=0.1,0.2", "word=a,b"], "--random": ["2", "speed=0.1..0.2"],
         "--design": ["design.csv"], "--repeat": ["2"], "--shard": ["1/2"], "--keep": ["all", "failed"], "--time-limit": ["20"],
         "--memory-limit": ["1000"], "--jobs": ["1", "2"],
         "info": ["hand.csv", "wii.csv"], "convert": ["hand.csv"], "synth": ["insertion", "sine"], "track": ["wii.csv"],
         "listen": ["WiiMote0@localhost:1"], "--duration": ["0.01", "0.02"], "--seed": ["5"], "--threads": ["2"],
         "--simd": ["scalar"], "-o": ["out.h5", "out.csv", "hand.csv", "notes.txt", "scene.lua"], "--out": ["out.h5", "out.csv", "run.h5"],
         "--set": ["speed=0.1", "voxelsize=0.02", "duration=0.01"], "--bind": ["hand=hand.csv"], "--voxel": ["0.002"],
         "--scale": ["0.001", "1e-9"], "--tracker": ["geometric", "scaat"], "--trajectory": ["sweep-x"], "--sensor": ["ideal"],
         "--second": ["wii.csv"], "--trace": ["wii.csv"], "--heads": ["wii.csv"], "--motion": ["wii.csv"], "--only": ["R1"],
         "--kind": ["haptic"], "--map": ["px=px"], "--time": ["t"], "--rate": ["1000"], "--port": ["0"], "--patience": ["0.1"]}


def options_of(command):
    done = subprocess.run([hostile.VERISIM, *command, "--help"], capture_output=True, text=True, check=True)
    return sorted(set(re.findall(r"(?<![\w-])--?[a-z][a-z-]*", done.stdout)))


OPTIONS = {tuple(command): options_of(command) for command in COMMANDS}


def inputs():
    with open(os.path.join(hostile.SOURCE, "LICENSE"), "rb") as f:
        licence = f.read()
    scene = SMALL.replace("duration = 0.3", "duration = 0.02")
    return {"scene.lua": scene.encode(), "hand.csv": as_csv("haptic").encode(), "wii.csv": as_csv("wii").encode(),
            "part.stl": turned_stl(0.0, 5.0, 10.0, 12).encode(), "notes.txt": licence,
            "design.csv": b"speed,seed\n0.1,1\n0.2,2\n"}


INPUTS = inputs()


def contents(folder):
    found = {}
    for name in INPUTS:
        with open(os.path.join(folder, name), "rb") as f:
            found[name] = hashlib.sha256(f.read()).hexdigest()
    return found


def fill(draw, folder):
    for name, content in INPUTS.items():
        with open(os.path.join(folder, name), "wb") as f:
            f.write(content)
    os.mkdir(os.path.join(folder, "folder"))
    os.symlink("loop", os.path.join(folder, "loop"))
    if draw.random() < 0.4:
        hostile.attempt(folder, ["run", "scene.lua", "-o", "run.h5", "--quiet"], SECONDS, {0})


def words(draw, command):
    """Half of them what a user would say."""
    found = list(command)
    usual = USUAL.get(command[-1], []) if command else []
    for _ in range(draw.choice([0, 1, 1, 1, 1, 2])):
        found.append(draw.choice(usual) if usual and draw.random() < 0.7 else draw.choice(FILES + FILES + VALUES))
    for _ in range(draw.choice([0, 1, 1, 2, 2, 3, 6])):
        option = draw.choice(OPTIONS[tuple(command)])
        value = draw.choice(USUAL.get(option, FILES) if draw.random() < 0.6 else FILES + VALUES)
        found += draw.choice([[option], [option, value], [option + "=" + value]] if option not in USUAL or draw.random() < 0.2
                             else [[option, value]])
    if draw.random() < 0.05:
        draw.shuffle(found)
    return found


def one(draw, folder):
    fill(draw, folder)
    command = draw.choice(COMMANDS)
    line = words(draw, command)
    before = contents(folder)
    done = hostile.attempt(folder, line, SECONDS, {0, 1, 2, 3, 4, 5}, interrupted=PATIENCE)
    after = contents(folder)
    changed = [name for name in INPUTS if before[name] != after[name]]
    if not all(may_replace(line, name) for name in changed):
        raise hostile.Broken(f"{line} changed {changed}")
    if done.code == 0 and "--json" in line and "--help" not in line and done.out.startswith(b"{"):
        hostile.strict_json(done)
    return f"{' '.join(command) or '(none)'}: {done.code}"


def may_replace(line, name):
    """What -o names, if it is a trace, or anything with --force."""
    outputs = {word.removeprefix("--out=").removeprefix("-o=") for before, word in zip([""] + line, line)
               if before in ("-o", "--out") or word.startswith(("--out=", "-o="))}
    return name in outputs and (name.endswith(".csv") or any(word.startswith("--force") for word in line))


if __name__ == "__main__":
    hostile.main(one)
