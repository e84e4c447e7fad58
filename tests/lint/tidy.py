"""Runs clang-tidy's short list (.clang-tidy) over one folder's sources: tidy.py CLANG_TIDY BUILD_FOLDER FOLDER.

A unit found clean is remembered by the content of all that it is made of, and not looked at again until that changes.
VERISIM_LONG_TESTS=1 looks at each file alone, which also proves that it compiles alone.
"""

import hashlib
import json
import os
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


def files_of(entry, build):
    """The source files that a compile command reads: those of its unit (cmake/flags.cmake, VERISIM_UNITY), or the one."""
    unit = pathlib.Path(entry["file"])
    files = re.findall(r'^#include "(.+)"', unit.read_text(), re.M) if unit.is_relative_to(build) else [entry["file"]]
    return [pathlib.Path(f).resolve() for f in files]


def alone(entry, build):
    """The same command for each file of a unit."""
    return [entry | {"file": str(f), "command": entry["command"].replace(entry["file"], str(f))}
            for f in files_of(entry, build)]


def fingerprint(entry, files, tool):
    parts = [tool, entry["command"].encode()] + [f.read_bytes() for f in sorted(set(files))]
    return hashlib.sha256(b"\0".join(hashlib.sha256(p).digest() for p in parts)).hexdigest()


def main():
    clang_tidy, build, folder = sys.argv[1], pathlib.Path(sys.argv[2]).resolve(), pathlib.Path(sys.argv[3]).resolve()
    root = pathlib.Path.cwd()
    clean = build / "tidy"
    entries = json.loads((build / "compile_commands.json").read_text())
    if os.environ.get("VERISIM_LONG_TESTS"):
        entries = [one for entry in entries for one in alone(entry, build)]
    database = clean / folder.name  # of the folder's own, for the folders run beside each other
    database.mkdir(parents=True, exist_ok=True)
    (database / "compile_commands.json").write_text(json.dumps(entries))
    version = subprocess.run([clang_tidy, "--version"], capture_output=True, check=True).stdout
    tool = version + (root / ".clang-tidy").read_bytes()
    headers = own_headers(build, root)

    looked_at, failed, seen = 0, 0, set()
    for entry in entries:
        sources = {f for f in files_of(entry, build) if f.is_relative_to(folder)}
        if not sources or sources <= seen:
            continue
        seen |= sources
        made_of = headers.get(entry.get("output", ""))
        mark = clean / fingerprint(entry, made_of + list(sources), tool) if made_of else None
        if mark and mark.exists():
            continue
        looked_at += len(sources)
        # A unit includes its files; that is what it is for.
        command = [clang_tidy, "--quiet", f"--config-file={root}/.clang-tidy", "--checks=-bugprone-suspicious-include",
                   "--extra-arg=-Wno-unused-command-line-argument",  # some are for g++ alone
                   "--extra-arg=-Wno-unknown-warning-option",
                   "-p", str(database), entry["file"]]
        result = subprocess.run(command, capture_output=True, text=True)
        if result.returncode:
            failed += 1
            print(result.stdout, result.stderr, flush=True)
        elif mark:
            mark.touch()
    print(f"{len(seen)} files, {looked_at} looked at anew, {failed} commands with findings")
    return 1 if failed or not seen else 0


if __name__ == "__main__":
    sys.exit(main())
