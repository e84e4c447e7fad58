"""Damaged models: STEP, BREP, STL, OBJ, PLY, glTF; shipped ones, a cube that is written here, and other people's.

`inspect` refuses each in one line, or shows it with finite numbers; what it shows can stand in a scene, or is refused there.
"""
import glob
import json
import os
import struct

import damage
import hostile

CORNERS = [(x * 0.04, y * 0.03, z * 0.02) for z in (0, 1) for y in (0, 1) for x in (0, 1)]
TRIANGLES = [t for a, b, c, d in [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
             for t in ((a, b, c), (a, c, d))]
SECONDS = 130  # the CAD program has 120 s; the largest model known to load takes a tenth of it


def binary_stl():
    return b"\0" * 80 + struct.pack("<I", 12) + b"".join(
        struct.pack("<12fH", 0, 0, 0, *(x for i in t for x in CORNERS[i]), 0) for t in TRIANGLES)


def text_stl():
    facets = ["facet normal 0 0 0\nouter loop\n" + "".join("vertex %g %g %g\n" % CORNERS[i] for i in t) +
              "endloop\nendfacet\n" for t in TRIANGLES]
    return ("solid cube\n" + "".join(facets) + "endsolid cube\n").encode()


def obj():
    return ("".join("v %g %g %g\n" % p for p in CORNERS) +
            "".join("f %d %d %d\n" % tuple(i + 1 for i in t) for t in TRIANGLES)).encode()


def ply():
    return ("ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
            "element face 12\nproperty list uchar int vertex_indices\nend_header\n" +
            "".join("%g %g %g\n" % p for p in CORNERS) + "".join("3 %d %d %d\n" % t for t in TRIANGLES)).encode()


def glb():
    points = b"".join(struct.pack("<3f", *p) for p in CORNERS)
    indices = b"".join(struct.pack("<3H", *t) for t in TRIANGLES)
    scene = json.dumps({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3", "min": list(CORNERS[0]),
                       "max": list(CORNERS[7])}, {"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR"}],
        "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": len(points)},
                        {"buffer": 0, "byteOffset": len(points), "byteLength": len(indices)}],
        "buffers": [{"byteLength": len(points) + len(indices)}]}).encode()
    scene += b" " * (-len(scene) % 4)
    return struct.pack("<4sII", b"glTF", 2, 28 + len(scene) + len(points) + len(indices)) + \
        struct.pack("<I4s", len(scene), b"JSON") + scene + struct.pack("<I4s", len(points + indices), b"BIN\0") + \
        points + indices


def read(path):
    with open(path, "rb") as f:
        return f.read()


def models():
    """(weight, suffix, content); what lies in shared data only where it is there, and only what loads in under a second."""
    found = [(6, ".stl", binary_stl()), (3, ".stl", text_stl()), (4, ".obj", obj()), (4, ".ply", ply()), (6, ".glb", glb())]
    for path in sorted(glob.glob(os.path.join(hostile.SOURCE, "scenarios", "models", "*.step"))):
        found.append((2, ".step", read(path)))
    for pattern in ("*.stp", "*.brep", "*.step", "*.STL", "*.stl", "*.obj"):
        for path in sorted(glob.glob(os.path.join(hostile.SHARED, "models", "*", pattern))):
            if os.path.getsize(path) < 90_000:
                found.append((1, os.path.splitext(path)[1].lower(), read(path)))
    return found


MODELS = models()


def one(draw, folder):
    _, suffix, content = draw.choices(MODELS, [weight for weight, _, _ in MODELS])[0]
    name = "part" + (suffix if draw.random() < 0.97 else draw.choice([".step", ".stl", ".glb", ".ply", ".brep", ".obj"]))
    with open(os.path.join(folder, name), "wb") as f:
        f.write(damage.damaged(draw, content))
    options = ["--voxel", "0.002"] if draw.random() < 0.2 else []
    done = hostile.attempt(folder, ["inspect", name, "--json", *options], SECONDS, {0, 3})
    if done.code != 0:
        return f"{suffix[1:]} refused"
    parts = hostile.strict_json(done)["parts"]
    if draw.random() < 0.8:
        return f"{suffix[1:]} shown"
    return f"{suffix[1:]} " + in_a_scene(draw, folder, name, parts)


def in_a_scene(draw, folder, name, parts):
    """A ball falls on the first part."""
    lower, upper = parts[0]["bounds_m"]
    size = max(max(b - a for a, b in zip(lower, upper)), 1e-9)
    middle = [(a + b) / 2 for a, b in zip(lower, upper)]
    with open(os.path.join(folder, "scene.lua"), "w") as f:
        f.write(f"""
defineSimulationParameters{{ duration = 0.01, gravity = {{0, 0, {-100 * size!r}}},
  hybrid = "{draw.choice(["off", "restore", "blend", "exact"])}" }}
addObject{{ name = "part", fixed = true, voxelsize = {size / 20!r}, Model "{name}" }}
addObject{{ name = "ball", voxelsize = {size / 20!r}, position = {{{middle[0]!r}, {middle[1]!r}, {upper[2] + size / 6!r}}},
  Solid.sphere{{ radius = {size / 6!r} }} }}
""")
    done = hostile.attempt(folder, ["run", "scene.lua", "-o", "out.h5", "--json"], SECONDS, {0, 3, 4})
    if done.code == 0:
        hostile.strict_json(done)
    if (done.code == 0) != os.path.exists(os.path.join(folder, "out.h5")) and done.code != 4:
        raise hostile.Broken("exit code 0 without a run file, or 3 with one")
    return {0: "simulated", 3: "refused in a scene", 4: "diverged"}[done.code]


if __name__ == "__main__":
    hostile.main(one)
