"""Runs clang-tidy's short list (.clang-tidy) over one folder's sources: tidy.py CLANG_TIDY BUILD_FOLDER FOLDER.

Most of the time goes into headers, so all units of a library (cmake/flags.cmake, VERISIM_UNITY) are looked at as one.
What was found clean is remembered by the content of all that it is made of, and not looked at again until that changes.
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


def object_of(entry):
    return re.search(r" -o (\S+)", entry["command"]).group(1)


def is_unit(entry, build):
    return pathlib.Path(entry["file"]).is_relative_to(build) and "/Unity/" in entry["file"]


def files_of(entry, build):
    """The source files that a compile command reads: those of its unit, or the one."""
    text = pathlib.Path(entry["file"]).read_text() if is_unit(entry, build) else f'#include "{entry["file"]}"'
    return [pathlib.Path(f).resolve() for f in re.findall(r'^#include "(.+)"', text, re.M)]


def of_file(entry, file):
    """The same command for another file."""
    return entry | {"file": str(file), "command": entry["command"].replace(entry["file"], str(file))}


def jobs_of(entries, folder, build):
    """What to look at: (compile commands that it stands for, the folder's files in it)."""
    libraries, seen = {}, set()
    for entry in entries:
        files = [f for f in files_of(entry, build) if f.is_relative_to(folder) and f not in seen]
        if not files:
            continue
        seen.update(files)
        if os.environ.get("VERISIM_LONG_TESTS"):
            yield from (([of_file(entry, f)], [f]) for f in files)
        elif is_unit(entry, build):
            units, of_all = libraries.setdefault(pathlib.Path(entry["file"]).parent.parent.stem, ([], []))
            units.append(entry)
            of_all += files
        else:
            yield [entry], files
    yield from libraries.values()


def command_for(entries, files, build, database):
    """One command for all: that of the first, for a file that includes the files."""
    if len(entries) == 1:
        return entries[0]
    together = database / f"{pathlib.Path(entries[0]['file']).parent.parent.stem}.cpp"
    together.write_text("".join(f'#include "{f}"\n' for f in files))
    return of_file(entries[0], together)


def fingerprint(command, files, tool):
    parts = [tool, command.encode()] + [f.read_bytes() for f in sorted(set(files))]
    return hashlib.sha256(b"\0".join(hashlib.sha256(p).digest() for p in parts)).hexdigest()


def main():
    clang_tidy, build, folder = sys.argv[1], pathlib.Path(sys.argv[2]).resolve(), pathlib.Path(sys.argv[3]).resolve()
    root = pathlib.Path.cwd()
    clean = build / "tidy"
    database = clean / folder.name  # of the folder's own, for the folders run beside each other
    database.mkdir(parents=True, exist_ok=True)
    jobs = list(jobs_of(json.loads((build / "compile_commands.json").read_text()), folder, build))
    commands = [command_for(entries, files, build, database) for entries, files in jobs]
    (database / "compile_commands.json").write_text(json.dumps(commands))
    version = subprocess.run([clang_tidy, "--version"], capture_output=True, check=True).stdout
    tool = version + (root / ".clang-tidy").read_bytes() + pathlib.Path(__file__).read_bytes()
    headers = own_headers(build, root)

    looked_at, failed, forgotten = 0, 0, 0
    for (entries, files), entry in zip(jobs, commands):
        made_of = [headers.get(object_of(e)) for e in entries]
        mark = None  # what ninja knows nothing of is always looked at
        if all(made_of):
            mark = clean / fingerprint(entry["command"], files + [f for some in made_of for f in some], tool)
            if mark.exists():
                continue
        forgotten += mark is None
        looked_at += len(files)
        # A unit includes its files; that is what it is for.
        command = [clang_tidy, "--quiet", f"--config-file={root}/.clang-tidy", "--checks=-bugprone-suspicious-include",
                   "--extra-arg=-Wno-unused-command-line-argument",  # some are for g++ alone
                   "--extra-arg=-Wno-unknown-warning-option",
                   "--extra-arg=-Wno-deprecated-declarations",  # libstdc++ 12's and OpenCASCADE's own
                   "-p", str(database), entry["file"]]
        result = subprocess.run(command, capture_output=True, text=True)
        if result.returncode:
            failed += 1
            print(result.stdout, result.stderr, flush=True)
        elif mark:
            mark.touch()
    print(f"{sum(len(files) for _, files in jobs)} files, {looked_at} looked at anew, {failed} commands with findings, "
          f"{forgotten} not remembered: ninja knows no headers of them")
    return 1 if failed or not jobs else 0


if __name__ == "__main__":
    sys.exit(main())
