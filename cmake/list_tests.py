"""Writes the ctest entries of a test program: list_tests.py PROGRAM OUTPUT.cmake. The name of an entry begins with the
file that the test stands in: memo_test.Suite.Case.
"""

import json
import pathlib
import subprocess
import sys
import tempfile


def main():
    program, output = sys.argv[1:]
    with tempfile.TemporaryDirectory() as folder:
        listed = pathlib.Path(folder) / "tests.json"
        subprocess.run([program, "--gtest_list_tests", f"--gtest_output=json:{listed}"], check=True, capture_output=True)
        suites = json.loads(listed.read_text())["testsuites"]
    entries, file_of = [], {}
    for suite in suites:
        for test in suite["testsuite"]:
            case, file = f"{suite['name']}.{test['name']}", pathlib.Path(test["file"])
            if case in file_of:
                sys.exit(f"{case} stands in {file_of[case]} and in {file}; one of them needs another name")
            file_of[case] = file
            name = f"{file.stem}.{case}"
            entries.append(f'add_test("{name}" "{program}" "--gtest_filter={case}")\n'
                           f'set_tests_properties("{name}" PROPERTIES TIMEOUT 600'
                           ' SKIP_REGULAR_EXPRESSION "\\\\[  SKIPPED \\\\]")\n')
    pathlib.Path(output).write_text("".join(entries))


if __name__ == "__main__":
    main()
