"""Damaged traces, CSV and HDF5, of every kind; and damaged CSV files that are no traces yet, through `trace convert --map`.

`trace info` refuses each in one line, or says what is in it; what it accepts can be converted, which changes nothing that
it says; what drives a device or a tracker ends as promised.
"""
import os
import subprocess
import tempfile

import damage
import hostile

SECONDS = 60  # of the wall clock: other work may have the processor
SCENE = """
defineSimulationParameters{ duration = 0.02 }
addObject{ name = "plate", fixed = true, voxelsize = 0.02, Solid.box{0.2, 0.2, 0.04} }
local box = addObject{ name = "box", voxelsize = 0.02, position = {0, 0, 0.08}, Solid.box{0.06, 0.06, 0.04} }
local hand = Devices.Replay{ name = "hand", trace = "%s" }
addDevice(hand)
grasp(hand, box)
"""
COLUMNS = {
    "haptic": "t,px,py,pz,qx,qy,qz,qw,fx,fy,fz,tx,ty,tz,button",
    "wii": "t,battery,gx,gy,gz,x1,y1,s1,x2,y2,s2,x3,y3,s3,x4,y4,s4,px,py,pz,qx,qy,qz,qw",
    "encoder": "t,e0,e1,e2,e3,vx,vy,omega"}
ROWS = {
    "haptic": lambda i: [0.001 * i, 0.01 * i, 0, 0.1, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0, i % 2],
    "wii": lambda i: [0.01 * i, 0.7, 0, 0, 1, 400 + i, 300, 3, 600 + i, 300, 3, *[-1] * 6, 0.001 * i, 0, 1, 0, 0, 0, 1],
    "encoder": lambda i: [0.01 * i, 3 * i, -3 * i, 3 * i, -3 * i, 0.1, 0, 0]}
RATES = {"haptic": 1000, "wii": 100, "encoder": 100}


def as_csv(kind):
    rows = [",".join(f"{x:g}" for x in ROWS[kind](i)) for i in range(40)]
    return f"# verisim-trace 1\n# kind: {kind}\n# rate_hz: {RATES[kind]}\n# source: made by hand\n{COLUMNS[kind]}\n" + \
        "\n".join(rows) + "\n"


def traces():
    """(kind, suffix, content)."""
    found = []
    with tempfile.TemporaryDirectory() as folder:
        for kind in COLUMNS:
            with open(os.path.join(folder, "t.csv"), "w") as f:
                f.write(as_csv(kind))
            found.append((kind, ".csv", as_csv(kind).encode()))
            subprocess.run([hostile.VERISIM, "trace", "convert", "t.csv", "-o", "t.h5", "--force"], cwd=folder, check=True)
            with open(os.path.join(folder, "t.h5"), "rb") as f:
                found.append((kind, ".h5", f.read()))
    return found


TRACES = traces()
FOREIGN = b"time_ms;x;y;z\n" + b"".join(b"%d;%d.5;%d;1e-3\n" % (i, i, -i) for i in range(50))


def one(draw, folder):
    if draw.random() < 0.1:
        return foreign(draw, folder)
    kind, suffix, content = draw.choice(TRACES)
    name = "trace" + suffix
    with open(os.path.join(folder, name), "wb") as f:
        f.write(damage.damaged(draw, content))
    options = [word for word in ("--resort", "--allow-gaps") if draw.random() < 0.3]
    done = hostile.attempt(folder, ["trace", "info", name, "--json", *options], SECONDS, {0, 3})
    accepted = done.code == 0
    use = draw.random()
    if accepted and use < 0.3:
        converted(draw, folder, name, options, hostile.strict_json(done))
        return f"{kind}{suffix} converted"
    if kind == "haptic" and use < 0.5:
        with open(os.path.join(folder, "scene.lua"), "w") as f:
            f.write(SCENE % name)
        ran = hostile.attempt(folder, ["run", "scene.lua", "-o", "out.h5", "--json"], SECONDS, {0, 3, 4})
        return f"{kind}{suffix} drove a device: {ran.code}"
    if kind == "wii" and use < 0.6:
        ran = hostile.attempt(folder, ["wii", "track", name, "--tracker", draw.choice(["geometric", "scaat"]), "-o", "poses.csv",
                                       *options], SECONDS, {0, 3})
        return f"{kind}{suffix} tracked: {ran.code}"
    return f"{kind}{suffix} " + ("accepted" if accepted else "refused")


def converted(draw, folder, name, options, said):
    out = "out" + draw.choice([".csv", ".h5"])
    hostile.attempt(folder, ["trace", "convert", name, "-o", out, *options], SECONDS, {0})
    again = hostile.strict_json(hostile.attempt(folder, ["trace", "info", out, "--json", "--allow-gaps"], SECONDS, {0}))
    for report in (said, again):
        report.pop("file", None)
    if said != again:
        raise hostile.Broken(f"{name} says {said}, converted {again}")


def foreign(draw, folder):
    with open(os.path.join(folder, "foreign.csv"), "wb") as f:
        f.write(damage.damaged(draw, FOREIGN))
    done = hostile.attempt(folder, ["trace", "convert", "foreign.csv", "-o", "out.csv", "--kind", "haptic", "--time", "time_ms",
                                    "--time-scale", "0.001", "--map", "px=x*0.001", "--map", "py=3", "--map", "pz=:0.1"],
                           SECONDS, {0, 3})
    if done.code == 0:
        hostile.attempt(folder, ["trace", "info", "out.csv", "--allow-gaps"], SECONDS, {0})
    return f"foreign {'converted' if done.code == 0 else 'refused'}"


if __name__ == "__main__":
    hostile.main(one)
