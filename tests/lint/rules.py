"""The rules of ARCHITECTURE.md that can be read off the sources: who may include whom, and what never happens.

Each rule is a function from {path: text} to a list of findings. A name is looked for wherever it stands, not only where
it is called: an alias of it is then found where the alias is made. What a rule lets through is listed with its reason,
and a row that is no longer needed is a finding too.
"""

import collections
import posixpath
import re

from source_text import ROOT, code_of, declarations, functions, header_in, includes, line_of, without_comments

# The dependency rule: what each folder may include and link besides itself. cli sees everything; what reads models
# (geometry/cad) is a program of its own, which nobody includes.
MAY_INCLUDE = {
    "base": "",
    "ruler": "base",
    "geometry": "base",
    "geometry/cad": "base geometry",
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
    "batch": "base record",
    "reproduce": "base geometry record voxel constraint wii device robot",
    "compare": "base record",
    "simulation": "base geometry voxel contact constraint exact dynamics device record",
    "stability": "base geometry device simulation",
    "tradeoff": "base",
    "script": "base geometry device robot wii record simulation tradeoff",
    "session": "base geometry record script simulation",
    "api": "base record session",
    "python": "api",
}

# The robot's firmware stands beside engine and knows nothing of it. What of it who may include: path prefixes of includers.
# What runs on the controller has no standard library: firmware, protocol, and what the compiler for it brings.
MAY_INCLUDE_FIRMWARE = {
    "firmware_sim/protocol/": ["firmware_sim/", "engine/robot/", "engine/cli/", "tests/"],
    "firmware_sim/board.hpp": ["firmware_sim/host/", "firmware_sim/avr/", "engine/robot/", "engine/cli/", "tests/"],
    "firmware_sim/firmware/": ["firmware_sim/firmware/", "firmware_sim/host/", "firmware_sim/avr/", "tests/firmware_sim/"],
    "firmware_sim/avr/": ["firmware_sim/avr/"],
}
ON_THE_CONTROLLER = ["firmware_sim/firmware/", "firmware_sim/protocol/", "firmware_sim/avr/main.cpp"]

# Each library has one home (path prefixes), so that a change of library is a change of one folder. A header that no
# row knows is a finding: a new library gets its row first.
EVERYWHERE = [""]
HOME_OF_LIBRARY = {
    r"[a-z_0-9]+": EVERYWHERE,  # C++'s own; the clock's and the random numbers' have rules of their own
    r"Eigen/(Core|Geometry|LU|Cholesky|Eigenvalues|SVD)|fmt/(format|ranges)\.h": EVERYWHERE,
    r"hdf5\.h": ["engine/record/"],
    r"lua\.hpp": ["engine/script/"],
    r"\w+\.hxx|assimp/.*": ["engine/geometry/cad/"],
    r"CGAL/.*": ["engine/geometry/self_intersection.cpp", "engine/geometry/recover/flat_regions.cpp"],
    r"fcl/.*": ["engine/contact/mesh_query.cpp", "engine/contact/broad_phase.cpp"],
    r"hwy/(highway|foreach_target)\.h": ["engine/contact/", "engine/constraint/restore_batch.cpp",
                                         "engine/exact/block_kernels.cpp"],
    r"CLI/CLI\.hpp": ["engine/cli/"],
    r"nlohmann/json\.hpp": ["engine/base/json.hpp"],
    r"sqlite3\.h": ["engine/batch/"],
    r"boost/math/(distributions|special_functions)/\w+\.hpp": ["engine/compare/", "engine/batch/"],
    r"sleef\.h|xxhash\.h|xxh_x86dispatch\.h|openssl/sha\.h": ["engine/base/"],
    # The operating system's. Sockets: a network is vrpn's alone; child processes are spoken to through a pair.
    r"(netinet/(in|tcp)|arpa/inet|netdb)\.h": ["engine/vrpn/socket.cpp"],
    r"sys/socket\.h": ["engine/vrpn/socket.cpp", "engine/geometry/cad_client.cpp", "engine/cli/line_program.cpp",
                       "firmware_sim/avr/avr_board.cpp"],
    r"poll\.h": ["engine/vrpn/", "engine/geometry/cad_client.cpp", "engine/cli/streams.cpp", "engine/cli/line_program.cpp",
                  "engine/batch/",
                  "firmware_sim/avr/avr_board.cpp"],
    r"(unistd|fcntl|sys/(stat|mman|resource))\.h": ["engine/vrpn/socket.cpp", "engine/geometry/cad_client.cpp",
                                                    "engine/geometry/cad/", "engine/record/", "engine/cli/", "engine/session/",
                                                    "engine/base/user_file.cpp", "engine/base/standard_streams.cpp",
                                                    "engine/batch/workers.cpp", "firmware_sim/avr/"],
    r"(spawn|sys/(wait|prctl))\.h": ["engine/geometry/cad_client.cpp", "engine/geometry/cad/", "engine/batch/workers.cpp",
                                     "engine/cli/program_runs.cpp", "engine/cli/tradeoff_peers.cpp", "engine/cli/line_program.cpp",
                                     "firmware_sim/avr/avr_board.cpp"],
    r"link\.h": ["engine/base/own_file.cpp"],
    r"pybind11/\w+\.h": ["engine/python/"],
    r"verisim/\w+\.hpp": ["engine/api/", "engine/python/"],
    r"(sim_avr|sim_elf|avr_(uart|ioport|extint))\.h": ["firmware_sim/avr/chip.cpp"],
    r"avr/\w+\.h": ["firmware_sim/avr/main.cpp"],
    r"stdint\.h": ["firmware_sim/"],
    r"(pthread|sched|sys/utsname|elf)\.h": ["engine/cli/", "engine/session/", "engine/batch/workers.cpp"],
}

# What a folder's CMakeLists.txt may link besides the project's own: the libraries above, by the names CMake knows.
HOME_OF_LINKED = {
    "verisim_protocol": ["engine/robot"], "verisim_firmware_host": ["engine/robot"],
    "verisim_flags": EVERYWHERE, "verisim_off_the_loop": EVERYWHERE, "verisim_small_arrays": ["engine/exact"], "Threads::Threads": EVERYWHERE,
    "Eigen3::Eigen": ["engine/base"], "fmt::fmt": ["engine/base"], "sleef": ["engine/base"], "xxhash": ["engine/base"],
    "OpenSSL::Crypto": ["engine/base"], "CGAL::CGAL": ["engine/geometry"],
    "hwy::hwy": ["engine/contact", "engine/constraint", "engine/exact"], "fcl": ["engine/contact"],
    "${HDF5_C_LIBRARIES}": ["engine/record"], "nlohmann_json::nlohmann_json": ["engine/base"],
    "SQLite::SQLite3": ["engine/batch"],
    "CLI11::CLI11": ["engine/cli"], "assimp::assimp": ["engine/geometry/cad"],
    "${VERISIM_OCCT_TOOLKITS}": ["engine/geometry/cad"],
}

MAY_READ_THE_CLOCK = {
    "engine/simulation/step.cpp": "times the stages of a frame",
    "engine/constraint/recognition_table.cpp": "times recognition, as table 7.1 does",
    "engine/reproduce/r5_blending.cpp": "times a solution of the comparator",
    "engine/wii/validate.cpp": "times a tracker's update",
    "engine/record/recorder.cpp": "waits for the disk",
    "engine/geometry/cad_client.cpp": "ends a child process that takes too long",
    "engine/batch/workers.cpp": "ends a run that takes too long, and tells how long each took",
    "engine/cli/doctor.cpp": "measures the clock itself",
    "engine/session/stop_watch.hpp": "tells how long something took",
    "engine/session/run_loop.cpp": "paces a run and times its frames",
    "engine/cli/wire_clock.cpp": "dates messages",
    "engine/cli/line_program.cpp": "ends a program that does not answer",
}

MAY_CALL_THE_C_LIBRARY = {
    "engine/base/pinned_math.hpp": "the pinned functions themselves",
    "engine/base/pinned_math.cpp": "the pinned functions themselves",
    "engine/voxel/limits.cpp": "rounds a number in an error's text",
    "engine/geometry/cad/extract.cpp": "the CAD kernel beside it calls them too; a run file holds what it gave",
    "engine/geometry/cad/entities.cpp": "the CAD kernel beside it calls them too; a run file holds what it gave",
}

MAY_OPEN_FILES = {
    "engine/base/user_file.cpp": "the place where files that a user names are opened for reading",
    "engine/record/prepared_store.cpp": "its own files in a folder of its own; what is read passes through UserFile",
    "engine/base/standard_streams.cpp": "occupies numbers of descriptors",
    "engine/record/file_replace.cpp": "writes and marks; opens nothing that could make it wait",
    "engine/record/hdf5_wrapper.cpp": "makes HDF5's files, at places that the writers have checked",
    "engine/record/heap_check.cpp": "maps run files that read_superblock has opened before",
    "engine/record/output_place.cpp": "HDF5, of files that UserFile has opened before",
    "engine/record/recover.cpp": "HDF5, of copies that it has made, and those copies",
    "engine/record/run_file.cpp": "HDF5, of files that read_superblock has opened before",
    "engine/record/run_writer.cpp": "HDF5, of files that it has made",
    "engine/record/trace_hdf5.cpp": "HDF5, of bytes in memory",
    "engine/geometry/write_file.cpp": "writes the models that scenarios ship",
    "engine/geometry/cad/step_file.cpp": "the kernel's readers, of files in memory",
    "engine/session/origin.cpp": "reads /proc/cpuinfo",
    "engine/batch/folder.cpp": "sees whether the folder of a batch is empty",
    "engine/batch/workers.cpp": "/dev/null, as what a worker has of stdin and stdout",
    "engine/compare/history.cpp": "lists the folder that --history names",
    "engine/cli/program_runs.cpp": "a folder and files of its own for the outputs of the programs that it starts",
}

KEPT_FOR_TESTS = {  # functions of the engine's headers that nothing in the engine calls
    "gap_at_end": "what the normal forces of a convex step belong to",
    "coil_energy": "of the robot's energy balance",
    "electrical_book": "of the robot's energy balance",
    "is_declared": "the charge of a function of scripts",
    "kappa": "speed that walls allow per room",
    "mechanics": "of the robot's energy balance",
    "radius_near": "of a recovered surface",
    "stored_energy": "of the robot's energy balance",
}

LINES_OF_A_FILE = 500
LINES_OF_A_SCREEN = 60
LONGER_THAN_A_SCREEN = {  # may become shorter, never longer
    "engine/exact/trim.cpp: Trim::Trim": 80,
    "engine/simulation/columns.cpp: Simulation::Implementation::make_schema": 63,
}


def folder_of(path):
    """The folder of engine that a path or a project's header belongs to."""
    parts = path.split("/")
    return "geometry/cad" if parts[1:3] == ["geometry", "cad"] else parts[1]


def is_at(path, homes):
    return any(path.startswith(home) for home in homes)


def seen(files, pattern, reason, text_of=code_of):
    findings = []
    for path, text in files.items():
        text = text_of(text)
        for match in re.finditer(pattern, text):
            findings.append(f"{path}:{line_of(text, match.start())}: {match[0].strip()}: {reason}")
    return findings


def seen_outside(allowed, files, pattern, reason):
    """As `seen` in the files that are not `allowed`; and those allowed that do not need to be."""
    findings = seen({p: t for p, t in files.items() if p not in allowed}, pattern, reason)
    for path in allowed:
        if path in files and not seen({path: files[path]}, pattern, reason):
            findings.append(f"{path} is let through for nothing: take away its row")
    return findings


def against_the_dependency_rule(files):
    findings = []
    for path, text in files.items():
        folder = folder_of(path)
        for include in includes(text):
            header = header_in(include)
            if not header.startswith("engine/"):
                continue
            wanted = folder_of(header)
            if folder != "cli" and wanted not in [folder, *MAY_INCLUDE.get(folder, "").split()]:
                findings.append(f"{path} includes {include}")
    return findings


def against_the_firmware_rule(files):
    findings = []
    for path, text in files.items():
        for include in includes(text):
            header = header_in(include)
            if header.startswith("firmware_sim/"):
                homes = [home for known, where in MAY_INCLUDE_FIRMWARE.items() if header.startswith(known) for home in where]
                is_allowed = is_at(path, homes)
            else:
                is_allowed = not path.startswith("firmware_sim/") or not header.startswith(("engine/", "tests/", "bench/"))
            if is_at(path, ON_THE_CONTROLLER) and not re.match(r"firmware_sim/(firmware|protocol)/|stdint\.h$|avr/", header):
                is_allowed = False
            if not is_allowed:
                findings.append(f"{path} includes {include}")
    return findings


def permissions_nobody_uses(files):
    used = {(folder_of(p), folder_of(header_in(i)))
            for p, text in files.items() for i in includes(text) if header_in(i).startswith("engine/")}
    there = {folder for folder, _ in used}
    return [f"MAY_INCLUDE lets {folder} include {other}; nothing there does"
            for folder, others in MAY_INCLUDE.items() for other in others.split()
            if folder in there and other in there and (folder, other) not in used]


def oddly_spelled_includes(files):
    """The other rules read includes: each has to say what it includes, by its whole path."""
    findings = []
    for path, text in files.items():
        for include in includes(text):
            header = header_in(include)
            is_ours = header.split("/")[0] in ("engine", "tests", "bench", "scenarios", "firmware_sim")
            if not include.startswith(('"', "<")):
                findings.append(f"{path} includes what a macro says: {include}")
            elif posixpath.normpath(header) != header or header.startswith(("/", "..")):
                findings.append(f"{path} goes a way round: {include}")
            elif is_ours and include.startswith("<"):
                findings.append(f"{path} writes the project's own with brackets: {include}")
            elif include.startswith('"') and not is_ours and not header.startswith("hwy/"):
                findings.append(f"{path} leaves out the folder: {include}")
            elif is_ours and path.startswith("engine/") and not header.startswith(("engine/", "firmware_sim/")):
                findings.append(f"{path} includes what is not the engine's: {include}")
        for own in re.findall(r'^[ \t]*#\s*define\b.*"([^"\n]*\.[ch]pp)"', without_comments(text), re.MULTILINE):
            if own != path:
                findings.append(f"{path} has a macro that names {own}")
    return findings


def libraries_away_from_home(files):
    findings = []
    for path, text in files.items():
        for header in map(header_in, includes(text)):
            known = [where for pattern, where in HOME_OF_LIBRARY.items() if re.fullmatch(pattern, header)]
            homes = [home for where in known for home in where]
            if not header.startswith(("engine/", "firmware_sim/")) and not is_at(path, homes):
                findings.append(f"{path} includes {header}; its home is {' or '.join(homes) or 'unknown'}")
    return findings


def links_against_the_dependency_rule(lists):
    """`lists`: {path of a CMakeLists.txt: text}. What a folder links is what it may include."""
    lists = {path: re.sub(r"#.*", "", text) for path, text in lists.items()}
    call = r"\b(add_library|add_executable|pybind11_add_module|target_link_libraries)\s*\(([^)]*)\)"
    commands = [(posixpath.dirname(path), command, arguments.split())
                for path, text in lists.items() for command, arguments in re.findall(call, text)]
    owner = {arguments[0]: folder for folder, command, arguments in commands if command != "target_link_libraries"}
    findings = []
    for folder, command, arguments in commands:
        if command != "target_link_libraries" or folder == "engine/cli":
            continue
        if owner.get(arguments[0]) != folder:
            findings.append(f"{folder} links for {arguments[0]}, which is another's")
        for linked in arguments[1:]:
            if linked in ("PUBLIC", "PRIVATE", "INTERFACE"):
                continue
            if linked in owner:
                allowed = [folder_of(folder), *MAY_INCLUDE[folder_of(folder)].split()]
                is_allowed = folder_of(owner[linked]) in allowed
            else:
                is_allowed = folder in HOME_OF_LINKED.get(linked, []) or HOME_OF_LINKED.get(linked) == EVERYWHERE
            if not is_allowed:
                findings.append(f"{folder} links {linked}")
    for path, text in lists.items():
        for word in re.findall(r"\b(?:link_libraries|link_directories|target_link_options)\s*\(|-l\w+", text):
            if not re.search(r"target_link_libraries", word):
                findings.append(f"{path}: {word}: links stand in target_link_libraries")
    return findings


CLOCK = "|".join([
    r"\bchrono\b", r"\b(?:steady|system|high_resolution|file|utc|tai|gps|local)_clock\b", r"\bnow\s*\(",
    r"<\s*(?:ctime|time\.h|sys/times?\.h|sys/timeb\.h|omp\.h|x86intrin\.h|immintrin\.h)\s*>",
    r"\b(?:clock_(?:gettime|getres|nanosleep)|timespec_get|gettimeofday|getrusage|asctime)\b",
    r"\b(?:local|gm|c|mk)time(?:_r)?\b",
    r"\b(?:strftime|difftime|omp_get_w(?:time|tick)|last_write_time|timerfd?_create|setitimer)\b", r"rdtsc",
    r"\b__builtin_readcyclecounter\b", r"\bstd\s*::\s*(?:time|clock)\b", r"(?<!\w)::\s*(?:time|clock)\b",
    r"(?<![\w.>:])time\s*\(\s*(?:nullptr|NULL|0|&)", r"(?<![\w.>:])clock\s*\(\s*\)(?!\s*const)",
])


def clocks(files):
    return seen_outside(MAY_READ_THE_CLOCK, files, CLOCK, "simulated time only; few places measure the wall clock")


RANDOM = "|".join([
    r"<\s*random\s*>", r"\b(?:mt19937|minstd_rand|ranlux|knuth_b|default_random_engine|random_device|seed_seq)\w*",
    r"\b\w+_(?:distribution|engine)\b",
    r"(?<![\w.>:])(?:s?rand(?:_r)?\s*\(|random\s*\(\s*\)(?!\s*(?:const|override|=)))",
    r"\bstd\s*::\s*(?:s?rand|shuffle|sample|random_shuffle)\b", r"(?<!\w)::\s*s?rand(?:om)?\b", r"\b[delmnj]rand48\b",
    r"\bsrand48\b", r"\b(?:getrandom|getentropy|arc4random\w*|RAND_(?:priv_)?bytes)\b", r"rdrand|rdseed",
    r"::\s*Random\s*\(", r"\bsetRandom\s*\(",
])


def random_numbers(files):
    reason = "engine/base/random.hpp gives the same numbers everywhere"
    return seen(files, RANDOM, reason) + seen(files, r"/dev/u?random", reason, without_comments)


FUNCTIONS = (r"(?:a?(?:sin|cos|tan)h?|atan2|sincos|exp(?:2|10|m1)?|log(?:2|10|1p)?|pow|cbrt|hypot|[lt]gamma|erfc?|beta"
             r"|riemann_zeta|cyl_\w+|sph_\w+|(?:assoc_)?l(?:egendre|aguerre)|hermite|(?:comp_)?ellint_\d)")
UNPINNED = "|".join([
    rf"\bstd\s*::\s*{FUNCTIONS}[fl]?\b", rf"(?<!\w)::\s*{FUNCTIONS}[fl]?\b",
    rf"\bnumext\s*::\s*\w*{FUNCTIONS}\b", rf"__builtin_{FUNCTIONS}[fl]?\b",
    rf"(?<![\w:])(?<!:: ){FUNCTIONS}[fl]?\s*\(", r"\busing\s+namespace\s+(?:std|pinned)\b",
    r"<\s*(?:complex|valarray)\s*>",
    r"\bstd\s*::\s*(?:complex|polar|arg|valarray|pow)\b",
    # Eigen's, that call the C library underneath.
    r"\bAngleAxis[fd]?\b", r"\bRotation2D[fd]?\b", r"[.>]\s*slerp\s*\(", r"\b(?:canonicalE|e)ulerAngles\s*\(",
    r"\bangularDistance\s*\(", r"\bcomputeDirect\s*\(", r"[.>]\s*arg\s*\(",
    r"<\s*unsupported/",
])


def unpinned_functions(files):
    return seen_outside(MAY_CALL_THE_C_LIBRARY, files, UNPINNED,
                        "engine/base/pinned_math.hpp gives the same bits on every CPU")


OPENING = "|".join([
    r"<\s*(?:fstream|stdio_ext\.h)\s*>", r"\b(?:basic_)?(?:[io]?fstream|filebuf)\b", r"\bf(?:re|d)?open(?:64)?\b",
    r"(?<!\w)::\s*(?:open(?:at2?)?|creat)(?:64)?\b", r"\bluaL_(?:load|do)file\w*",
    r"(?<![\w.>:])(?:open(?:at2?)?|creat)(?:64)?\s*\(\s*(?!L,)\S+,",
    r"\bmk(?:ostemps?|stemps?|dtemp)\b", r"\bH5F(?:open|create)\b", r"[.>]\s*ReadFile\s*\(",
    r"\b(?:opendir|(?:recursive_)?directory_iterator|scandir|nftw)\b",
])


FOLDER_NAMED = r"\b(?:temp_directory_path|TempDir|mkdtemp|tmpnam|tempnam)\b|\"/(?:var/)?tmp\b"


def folders_named_by_a_test(files):
    """Two tests that run beside each other under one name: one removes what the other reads."""
    elsewhere = {path: text for path, text in files.items() if path != "tests/support/folder.hpp"}
    return seen(elsewhere, FOLDER_NAMED, "tests/support/folder.hpp makes a folder of a test's own", without_comments)


def files_opened_elsewhere(files):
    return seen_outside(MAY_OPEN_FILES, files, OPENING,
                        "engine/base/user_file.hpp opens what a user names: a FIFO makes any other place wait")


def functions_nobody_calls(files):
    """Functions of headers whose name stands nowhere but where they are declared and defined."""
    words, declared, homes = collections.Counter(), collections.Counter(), {}
    for path, text in files.items():
        words.update(re.findall(r"\w+", code_of(text)))
        names = declarations(text)
        declared.update(names)
        if path.endswith(".hpp"):
            homes.update((name, path) for name in names)
    dead = {name: path for name, path in homes.items() if words[name] <= declared[name]}
    kept_for_nothing = [name for name in KEPT_FOR_TESTS if name in words and name not in dead]
    return [f"{path}: nothing calls {name}" for name, path in dead.items() if name not in KEPT_FOR_TESTS] + [
        f"{name} is called now: take away its row" for name in kept_for_nothing]


def long_files(files):
    return [f"{path} has {n} lines" for path, text in files.items() if (n := len(text.splitlines())) > LINES_OF_A_FILE]


def long_functions(files):
    findings, there = [], set()
    for path, text in files.items():
        for name, lines in functions(text):
            row = f"{path}: {name}"
            allowed = LONGER_THAN_A_SCREEN.get(row, LINES_OF_A_SCREEN)
            if lines > LINES_OF_A_SCREEN:
                there.add(row)
            if lines > allowed:
                findings.append(f"{row} has {lines} lines, more than {allowed}")
    return findings + [f"{row} is no longer than a screen: take away its row"
                       for row in LONGER_THAN_A_SCREEN if row.split(":")[0] in files and row not in there]
