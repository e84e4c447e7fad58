"""The rules of ARCHITECTURE.md that can be read off the sources: who may include whom, and what never happens.

Each rule is a function from {path: text} to a list of findings; each test runs one over the project, and once over a
planted violation, for a rule that can no longer fail guards nothing.
"""

import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]

# The dependency rule. cli sees everything.
MAY_INCLUDE = {
    "base": "",
    "geometry": "base",
    "voxel": "base geometry",
    "contact": "base geometry voxel",
    "constraint": "base geometry",
    "exact": "base geometry",
    "dynamics": "base",
    "device": "base",
    "robot": "base",
    "wii": "base",
    "vrpn": "base",
    "record": "base",
    "reproduce": "base geometry record voxel contact constraint wii",
    "simulation": "base geometry voxel contact constraint exact dynamics device robot wii record",
    "script": "base geometry device robot wii record simulation",
}

# Each library has one home (a path prefix), so that a change of library is a change of one folder.
HOME_OF_LIBRARY = {
    r"hdf5\.h|H5\w+\.h": ["engine/record/"],
    r"lua\.hpp|lua\.h|lauxlib\.h": ["engine/script/"],
    r"(BRep|TopExp|TopoDS|TopAbs|gp_|Geom|STEP|XCAF|TDF|TDoc|Poly_|Standard_|GProp)\w*\.hxx": ["engine/geometry/cad/"],
    r"assimp/.*": ["engine/geometry/cad/"],
    r"CGAL/.*": ["engine/geometry/"],
    r"fcl/.*": ["engine/contact/"],
    r"hwy/.*": ["engine/contact/", "engine/constraint/restore_batch.cpp"],
    r"CLI/.*": ["engine/cli/"],
    r"nlohmann/.*": ["engine/script/", "engine/cli/"],
    r"(netinet/.*|arpa/inet|netdb)\.h": ["engine/vrpn/"],
    r"sleef\.h|xxhash\.h|openssl/.*": ["engine/base/"],
}

# Where the wall clock may be read: to time stages, to pace a run, to wait for the disk or a child process, to date
# messages.
MAY_READ_THE_CLOCK = {
    "engine/reproduce/r5_blending.cpp",
    "engine/simulation/step.cpp",
    "engine/record/recorder.cpp",
    "engine/geometry/cad_client.cpp",
    "engine/cli/doctor.cpp",
    "engine/cli/reproduce.cpp",
    "engine/cli/run_loop.cpp",
    "engine/cli/session.cpp",
    "engine/cli/wire_clock.cpp",
}

# Folders whose numbers enter the state, and the files there that use the C library's functions for an error's text.
IN_THE_STATE = ("base", "voxel", "contact", "constraint", "exact", "dynamics", "device", "robot", "simulation", "wii")
OUT_OF_THE_STATE = {"engine/base/pinned_math.cpp", "engine/voxel/limits.cpp"}


def sources(*folders):
    found = {}
    for folder in folders:
        for path in sorted((ROOT / folder).rglob("*.[ch]pp")):
            found[path.relative_to(ROOT).as_posix()] = path.read_text()
    return found


def code_lines(text):
    """Number and text of each line without its // comment."""
    return [(i, re.sub(r"//.*", "", line)) for i, line in enumerate(text.splitlines(), 1)]


def includes(text):
    return re.findall(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]', text, re.MULTILINE)


def folder_of(path):
    return path.split("/")[1]


def against_the_dependency_rule(files):
    findings = []
    for path, text in files.items():
        folder = folder_of(path)
        if folder == "cli":
            continue
        for header in includes(text):
            if header.startswith("engine/") and folder_of(header) not in [folder, *MAY_INCLUDE[folder].split()]:
                findings.append(f"{path} includes {header}")
    return findings


def libraries_away_from_home(files):
    return [
        f"{path} includes {header}; its home is {' or '.join(homes)}"
        for path, text in files.items()
        for header in includes(text)
        for pattern, homes in HOME_OF_LIBRARY.items()
        if re.fullmatch(pattern, header) and not any(path.startswith(home) for home in homes)
    ]


def lines_that_match(files, pattern, reason):
    return [
        f"{path}:{i}: {line.strip()}: {reason}"
        for path, text in files.items()
        for i, line in code_lines(text)
        if re.search(pattern, line)
    ]


def clocks(files):
    allowed = {path: text for path, text in files.items() if path not in MAY_READ_THE_CLOCK}
    pattern = r"_clock::now|clock_gettime|gettimeofday|\bstd::time\(|__rdtsc"
    return lines_that_match(allowed, pattern, "simulated time only; the wall clock is measured in few places")


def random_numbers(files):
    pattern = r"std::(mt19937|minstd_rand|default_random_engine|random_device|\w+_distribution)|\bs?rand\("
    return lines_that_match(files, pattern, "engine/base/random.hpp gives the same numbers everywhere")


def unpinned_functions(files):
    in_state = {p: t for p, t in files.items() if folder_of(p) in IN_THE_STATE and p not in OUT_OF_THE_STATE}
    pattern = r"std::(sin|cos|tan|asin|acos|atan2?|sinh|cosh|tanh|exp2?|log|log2|pow|cbrt|hypot)\("
    return lines_that_match(in_state, pattern, "engine/base/pinned_math.hpp gives the same bits on every CPU")


def long_files(files):
    return [f"{path} has {n} lines" for path, text in files.items() if (n := text.count("\n")) > 500]


def names_of_nothing(documents):
    """Paths and tests that a document names in backticks and that do not exist."""
    tests = {path.stem for path in (ROOT / "tests").rglob("*_test.*")}
    findings = []
    for path, text in documents.items():
        for name in re.findall(r"`([^`\s]+)`", text):
            if re.match(r"(engine|tests|bench|cmake|scenarios|traces|firmware_sim|reports)/", name):
                if "*" not in name and not (ROOT / name).exists():
                    findings.append(f"{path} names {name}")
            elif re.fullmatch(r"\w+_test", name) and name not in tests:
                findings.append(f"{path} names {name}")
    return findings


class Rules(unittest.TestCase):
    def holds(self, rule, files, planted):
        self.assertEqual(rule(files), [], "\n".join(rule(files)))
        self.assertNotEqual(rule(planted), [], "the rule no longer sees a violation")

    def test_a_folder_includes_only_what_the_dependency_rule_allows(self):
        self.holds(against_the_dependency_rule, sources("engine"),
                   {"engine/voxel/a.hpp": '#include "engine/dynamics/body.hpp"\n'})

    def test_a_library_is_included_only_at_its_home(self):
        self.holds(libraries_away_from_home, sources("engine"), {"engine/simulation/a.cpp": "#include <hdf5.h>\n"})

    def test_the_wall_clock_is_read_in_few_places(self):
        self.holds(clocks, sources("engine"),
                   {"engine/dynamics/a.cpp": "auto t = std::chrono::steady_clock::now();\n"})

    def test_random_numbers_come_from_named_streams(self):
        self.holds(random_numbers, sources("engine"), {"engine/device/a.cpp": "std::mt19937 g(1);\n"})

    def test_functions_that_enter_the_state_are_pinned(self):
        self.holds(unpinned_functions, sources("engine"), {"engine/device/a.cpp": "double s = std::sin(x);\n"})

    def test_no_file_is_longer_than_500_lines(self):
        self.holds(long_files, sources("engine", "tests", "bench"), {"engine/device/a.cpp": "\n" * 501})

    def test_the_documents_name_only_what_exists(self):
        documents = {p.relative_to(ROOT).as_posix(): p.read_text()
                     for p in [*ROOT.glob("*.md"), *ROOT.glob("engine/**/README.md")]}
        self.holds(names_of_nothing, documents, {"README.md": "see `engine/nothing.hpp`"})


if __name__ == "__main__":
    unittest.main()
