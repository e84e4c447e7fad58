"""Runs clang-tidy's short list (.clang-tidy) over one folder's sources: tidy.py CLANG_TIDY BUILD_FOLDER FOLDER.

A file found clean is remembered by the content of all that it is made of, and not looked at again until that changes.
"""

import hashlib
import json
import pathlib
import re
import subprocess
import sys


def own_headers(build, root):
    """Object -> the project's files it was compiled from, as ninja remembers them."""
    deps = subprocess.run(["ninja", "-C", str(build), "-t", "deps"], capture_output=True, text=True, check=False).stdout
    headers, current = {}, []
    for line in deps.splitlines():
        if line and not line.startswith(" "):
            current = headers.setdefault(line.split(":")[0], [])
        elif line.strip():
            path = (build / line.strip()).resolve()
            if path.is_relative_to(root) and path.is_file():
                current.append(path)
    return headers


def commands(build):
    """What compiles each source file alone: a unit of several (cmake/flags.cmake, VERISIM_UNITY) counts as its files."""
    alone = []
    for entry in json.loads((build / "compile_commands.json").read_text()):
        unit = pathlib.Path(entry["file"])
        files = re.findall(r'^#include "(.+)"', unit.read_text(), re.M) if unit.is_relative_to(build) else [entry["file"]]
        alone += [entry | {"file": f, "command": entry["command"].replace(entry["file"], f)} for f in files]
    return alone


def fingerprint(entry, files, tool):
    parts = [tool, entry["command"].encode()] + [f.read_bytes() for f in sorted(set(files))]
    return hashlib.sha256(b"\0".join(hashlib.sha256(p).digest() for p in parts)).hexdigest()


def main():
    clang_tidy, build, folder = sys.argv[1], pathlib.Path(sys.argv[2]).resolve(), pathlib.Path(sys.argv[3]).resolve()
    root = pathlib.Path.cwd()
    clean = build / "tidy"
    database = clean / folder.name  # of the folder's own, for the folders run beside each other
    database.mkdir(parents=True, exist_ok=True)
    entries = commands(build)
    (database / "compile_commands.json").write_text(json.dumps(entries))
    version = subprocess.run([clang_tidy, "--version"], capture_output=True, check=True).stdout
    tool = version + (root / ".clang-tidy").read_bytes()
    headers = own_headers(build, root)

    looked_at, failed, seen = 0, 0, set()
    for entry in entries:
        source = pathlib.Path(entry["file"]).resolve()
        if not source.is_relative_to(folder) or source in seen:
            continue
        seen.add(source)
        made_of = headers.get(entry.get("output", ""))
        mark = clean / fingerprint(entry, made_of + [source], tool) if made_of else None
        if mark and mark.exists():
            continue
        looked_at += 1
        result = subprocess.run([clang_tidy, "--quiet", "-p", str(database), str(source)], capture_output=True, text=True)
        if result.returncode:
            failed += 1
            print(result.stdout, result.stderr, flush=True)
        elif mark:
            mark.touch()
    print(f"{len(seen)} files, {looked_at} looked at anew, {failed} with findings")
    return 1 if failed or not seen else 0


if __name__ == "__main__":
    sys.exit(main())
