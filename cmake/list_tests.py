"""Writes the ctest entries of a test program: list_tests.py PROGRAM OUTPUT.cmake [LEFT_OUT.txt].

The name of an entry begins with the file that the test stands in: memo_test.Suite.Case. A case with parameters is one entry, so that its instances share what
they compare themselves with; where a file skips tests each is an entry, for ctest knows an entry as skipped or not. An
instance that is skipped all the same fails its entry: nothing is skipped unseen. LEFT_OUT.txt: tests that have no entry.
"""

import functools
import json
import pathlib
import re
import subprocess
import sys
import tempfile


@functools.cache
def skips(file):
    return "GTEST_SKIP" in (pathlib.Path(__file__).parents[1] / file).read_text()


def without(entries, files, left_out):
    """The entries of tests but those that fit a line of LEFT_OUT.txt; a line that names one of the files must fit one."""
    known = {f"{file.parent.name}/{file.stem}" for file in files}
    for line in pathlib.Path(left_out).read_text().splitlines():
        file = line.split("\\.")[0]
        if line and not line.startswith("#") and not pathlib.Path(left_out).parent.joinpath(file + ".cpp").exists():
            sys.exit(f"{left_out}: '{line}' names no file")
        if file not in known:
            continue
        fits = [name for name in entries if re.fullmatch(line.partition("/")[2], name)]
        if not fits:
            sys.exit(f"{left_out}: '{line}' fits no test")
        for name in fits:
            del entries[name]
    return entries


def main():
    program, output, *left_out = sys.argv[1:]
    with tempfile.TemporaryDirectory() as folder:
        listed = pathlib.Path(folder) / "tests.json"
        subprocess.run([program, "--gtest_list_tests", f"--gtest_output=json:{listed}"], check=True, capture_output=True)
        suites = json.loads(listed.read_text())["testsuites"]
    file_of, entries = {}, {}
    for suite in suites:
        for test in suite["testsuite"]:
            case, file = f"{suite['name']}.{test['name']}", pathlib.Path(test["file"])
            if case in file_of:
                sys.exit(f"{case} stands in {file_of[case]} and in {file}; one of them needs another name")
            file_of[case] = file
            whole, parameter, _ = case.rpartition("/")
            together = parameter and "/" in test["name"] and not skips(file)
            name = f"{file.stem}.{whole if together else case}"
            entries[name] = (f'add_test("{name}" "{program}" "--gtest_filter={whole + "/*" if together else case}")\n'
                             f'set_tests_properties("{name}" PROPERTIES TIMEOUT 600'
                             f' {"FAIL" if together else "SKIP"}_REGULAR_EXPRESSION "\\\\[  SKIPPED \\\\]")\n')
    for path in left_out:
        entries = without(entries, file_of.values(), path)
    pathlib.Path(output).write_text("".join(entries.values()))


if __name__ == "__main__":
    main()
