"""Every rule of rules.py and documents.py, once over the project and once over each way round it that is known.

A rule that can no longer fail guards nothing: each planted violation is the only one in its file and has to be found by
itself, and what stands beside it as harmless must not be.
"""

import unittest

import documents
import rules
from source_text import ROOT, comments_of, functions, includes, sources

ENGINE = sources("engine")
FIRMWARE = sources("firmware_sim")
ALL = sources("engine", "firmware_sim", "tests", "bench", "scenarios")
IN_STATE = "engine/device/a.cpp"


class Rules(unittest.TestCase):
    def holds(self, rule, files, *, planted, harmless=()):
        """`planted`, `harmless`: texts of IN_STATE, or pairs of a path and its text."""
        self.assertEqual(rule(files), [], "\n".join(rule(files)))
        for kind, texts in (("violation", planted), ("harmless", harmless)):
            for text in texts:
                path, text = text if isinstance(text, tuple) else (IN_STATE, text)
                with self.subTest(kind, path=path, text=text[:80]):
                    self.assertEqual(len(rule({path: text})) > 0, kind == "violation", rule({path: text}))

    def test_a_folder_includes_only_what_the_dependency_rule_allows(self):
        self.holds(rules.against_the_dependency_rule, ENGINE, planted=[
            ("engine/voxel/a.hpp", '#include "engine/dynamics/body.hpp"\n'),
            ("engine/voxel/a.hpp", "#include <engine/dynamics/body.hpp>\n"),
            ("engine/voxel/a.hpp", '  #  include "engine/dynamics/body.hpp"\n'),
            ("engine/voxel/a.hpp", '/* why */ #include_next "engine/dynamics/body.hpp"\n'),
            ("engine/voxel/a.hpp", '#include \\\n  "engine/dynamics/body.hpp"\n'),
            ("engine/voxel/a.hpp", '%:include "engine/dynamics/body.hpp"\n'),
            ("engine/geometry/part.cpp", '#include "engine/geometry/cad/extract.hpp"\n'),
            ("engine/geometry/cad/a.cpp", '#include "engine/voxel/voxmap.hpp"\n'),
            ("engine/wii/a.cpp", '#include "engine/cli/wire_clock.hpp"\n'),
            ("engine/nowhere/a.cpp", '#include "engine/base/pose.hpp"\n'),
        ], harmless=[
            ("engine/voxel/a.hpp", '#include "engine/geometry/mesh.hpp"\n'),
            ("engine/voxel/a.hpp", '// #include "engine/dynamics/body.hpp"\n'),
            ("engine/voxel/a.hpp", '/*\n#include "engine/dynamics/body.hpp"\n*/\n'),
            ("engine/cli/a.cpp", '#include "engine/voxel/voxmap.hpp"\n'),
        ])

    def test_the_firmware_stands_apart(self):
        self.holds(rules.against_the_firmware_rule, ALL, planted=[
            ("firmware_sim/host/a.cpp", '#include "engine/base/error.hpp"\n'),
            ("firmware_sim/protocol/a.hpp", "#include <cstdint>\n"),
            ("firmware_sim/firmware/a.cpp", "#include <math.h>\n"),
            ("firmware_sim/firmware/a.cpp", '#include "firmware_sim/board.hpp"\n'),
            ("firmware_sim/protocol/a.hpp", '#include "firmware_sim/firmware/pid.hpp"\n'),
            ("firmware_sim/avr/main.cpp", "#include <vector>\n"),
            ("engine/robot/a.cpp", '#include "firmware_sim/firmware/pid.hpp"\n'),
            ("engine/robot/a.cpp", '#include "firmware_sim/avr/wire.hpp"\n'),
            ("engine/device/a.cpp", '#include "firmware_sim/board.hpp"\n'),
            ("engine/device/a.cpp", '#include "firmware_sim/protocol/frame.hpp"\n'),
        ], harmless=[
            ("engine/robot/a.cpp", '#include "firmware_sim/board.hpp"\n#include "firmware_sim/protocol/frame.hpp"\n'),
            ("engine/cli/a.cpp", '#include "firmware_sim/protocol/frame.hpp"\n'),
            ("firmware_sim/host/a.cpp", '#include <vector>\n#include "firmware_sim/firmware/firmware.hpp"\n'),
            ("firmware_sim/avr/main.cpp", "#include <avr/io.h>\n#include <stdint.h>\n"),
        ])

    def test_the_dependency_rule_allows_no_more_than_is_used(self):
        self.assertEqual(rules.permissions_nobody_uses(ENGINE), [])
        there = {"engine/base/a.hpp": '#include "engine/base/b.hpp"\n',
                 "engine/voxel/a.hpp": '#include "engine/voxel/b.hpp"\n'}
        findings = rules.permissions_nobody_uses(there)
        self.assertEqual(findings, ["MAY_INCLUDE lets voxel include base; nothing there does"])

    def test_an_include_says_what_it_includes(self):
        self.holds(rules.oddly_spelled_includes, ALL, planted=[
            "#include <engine/base/pose.hpp>\n",
            '#include "../dynamics/body.hpp"\n',
            '#include "engine/device/../dynamics/body.hpp"\n',
            '#include "engine//base/pose.hpp"\n',
            '#include "./hand.hpp"\n',
            '#include "hand.hpp"\n',
            '#include "/usr/include/math.h"\n',
            "#include HEADER_OF_ANOTHER\n",
            '#include "tests/support/bodies.hpp"\n',
            '#include "bench/promise.hpp"\n',
            '#define HWY_TARGET_INCLUDE "engine/script/values.hpp"\n',
        ], harmless=[
            '#include "engine/base/pose.hpp"\n#include <vector>\n#include "hwy/highway.h"\n',
            f'#define HWY_TARGET_INCLUDE "{IN_STATE}"\n',
            ("tests/device/a.cpp", '#include "tests/support/bodies.hpp"\n'),
        ])

    def test_a_library_is_included_only_at_its_home(self):
        self.holds(rules.libraries_away_from_home, {**ENGINE, **FIRMWARE}, planted=[
            ("engine/simulation/a.cpp", f"#include <{header}>\n")
            for header in ("hdf5.h", "H5Cpp.h", "hdf5/serial/hdf5.h", "highfive/H5File.hpp", "lua.hpp", "lua.h",
                           "lua5.1/lua.hpp",
                           "sol/sol.hpp", "gp_Pnt.hxx", "opencascade/gp_Pnt.hxx", "assimp/scene.h",
                           "CGAL/box_intersection_d.h",
                           "fcl/geometry/shape/box.h", "hwy/highway.h", "hwy/contrib/math/math-inl.h", "CLI/CLI.hpp",
                           "nlohmann/json.hpp", "sleef.h", "xxhash.h", "openssl/sha.h", "openssl/rand.h",
                           "netinet/in.h",
                           "arpa/inet.h", "netdb.h", "sys/socket.h", "sys/un.h", "poll.h", "sys/epoll.h", "unistd.h",
                           "spawn.h", "pthread.h", "boost/asio.hpp", "unsupported/Eigen/MatrixFunctions", "time.h",
                           "math.h", "stdint.h", "string.h")
        ] + [
            ("engine/simulation/a.cpp", '#include "hdf5.h"\n'),
            ("engine/geometry/mesh.cpp", "#include <gp_Pnt.hxx>\n"),
            ("engine/geometry/mesh.cpp", "#include <CGAL/property_map.h>\n"),
            ("engine/vrpn/server.cpp", "#include <sys/socket.h>\n"),
        ], harmless=["#include <vector>\n#include <Eigen/Core>\n#include <fmt/format.h>\n",
                     ("engine/record/a.cpp", "#include <hdf5.h>\n")])

    def test_a_folder_links_only_what_it_may_include(self):
        lists = {p.relative_to(ROOT).as_posix(): p.read_text() for p in (ROOT / "engine").rglob("CMakeLists.txt")}
        self.assertEqual(rules.links_against_the_dependency_rule(lists), [])
        for folder, line in (
                ("voxel", "target_link_libraries(verisim_voxel PUBLIC verisim_dynamics)"),
                ("voxel", "target_link_libraries(verisim_voxel\n  PUBLIC verisim_base\n  PRIVATE verisim_script)"),
                ("voxel", "target_link_libraries( verisim_voxel verisim_constraint_table)"),
                ("dynamics", "target_link_libraries(verisim_dynamics PUBLIC verisim_parts)"),
                ("dynamics", "target_link_libraries(verisim_dynamics PRIVATE ${HDF5_C_LIBRARIES})"),
                ("dynamics", "target_link_libraries(verisim_dynamics PRIVATE hdf5)"),
                ("dynamics", "target_link_libraries(verisim_voxel PRIVATE verisim_base)"),
                ("dynamics", "link_libraries(verisim_script)"),
                ("dynamics", "target_link_options(verisim_dynamics PRIVATE -lhdf5)"),
                ("dynamics", "set(CMAKE_CXX_STANDARD_LIBRARIES -lhdf5)")):
            path = f"engine/{folder}/CMakeLists.txt"
            with self.subTest(line):
                self.assertNotEqual(rules.links_against_the_dependency_rule({**lists, path: lists[path] + line}), [])

    def test_the_wall_clock_is_read_in_few_places(self):
        self.holds(rules.clocks, {**ENGINE, **FIRMWARE}, planted=[
            "auto t = std::chrono::steady_clock::now();\n",
            "using Clock = std::chrono::steady_clock;\n",
            "namespace c = std::chrono;\n",
            "using namespace std::chrono;\n",
            "using std::chrono::system_clock;\n",
            "std :: chrono :: seconds s(1);\n",
            "const auto begin = Clock::now();\n",
            "const auto begin = Clock :: now ( );\n",
            "auto read = &high_resolution_clock::now;\n",
            "#include <chrono>\n", "#include <ctime>\n", "#include <time.h>\n", "#include <sys/time.h>\n",
            "#include <omp.h>\n",
            "clock_gettime(CLOCK_MONOTONIC, &t);\n", "auto f = clock_gettime;\n", "timespec_get(&t, TIME_UTC);\n",
            "gettimeofday(&t, nullptr);\n", "time_t t = time(nullptr);\n", "time(&t);\n",
            "auto t = std::time(nullptr);\n",
            "auto t = ::time(nullptr);\n", "auto t = clock();\n", "auto t = std::clock();\n", "localtime(&t);\n",
            "gmtime_r(&t, &out);\n", "getrusage(RUSAGE_SELF, &u);\n", "double t = omp_get_wtime();\n",
            "auto t = __rdtsc();\n",
            'asm volatile("" : "=a"(t)); __builtin_ia32_rdtscp(&t);\n', "__builtin_readcyclecounter();\n",
            "std::filesystem::last_write_time(p);\n",
            'const char* s = "//"; auto t = std::chrono::steady_clock::now();\n',
            ("engine/record/recorder.cpp", "int waits_no_longer;\n"),
        ], harmless=[
            "const double t = simulation.time();\n", "double time() const;\n", "events.push_back({time(), kind});\n",
            "virtual double clock() const = 0;\n", "sandbox.clock();\n", "// std::chrono::steady_clock::now()\n",
            '/* Clock::now() */ fail("no clock_gettime here");\n', "simulation->add_clock(1, f);\n",
            ("engine/record/recorder.cpp", "#include <chrono>\n"),
        ])

    def test_random_numbers_come_from_named_streams(self):
        self.holds(rules.random_numbers, ALL, planted=[
            "std::mt19937 g(1);\n", "using G = std::mt19937_64;\n", "using std::default_random_engine;\n",
            "std::minstd_rand0 g;\n", "ranlux48 g;\n", "std::random_device d;\n", "std::normal_distribution<> n;\n",
            "std::linear_congruential_engine<unsigned, 1, 1, 1> g;\n", "#include <random>\n", "int r = rand();\n",
            "int r = std::rand();\n", "auto f = &std::rand;\n", "auto f = ::rand;\n", "srand(1);\n", "rand_r(&seed);\n",
            "long r = random();\n", "long r = ::random();\n", "double r = drand48();\n", "srand48(1);\n",
            "getrandom(&r, 8, 0);\n", "RAND_bytes(b, 8);\n", "arc4random_uniform(3);\n",
            "__builtin_ia32_rdrand64_step(&r);\n",
            "std::shuffle(a, b, g);\n", "const Vector3d v = Vector3d::Random();\n", "v.setRandom();\n",
            'std::ifstream f("/dev/urandom");\n',
        ], harmless=["const RandomStream random(1, name);\n", "double random() override;\n", "stream.random();\n",
                     "random.uniform(2);\n", "// std::mt19937\n"])

    def test_functions_that_enter_the_state_are_pinned(self):
        self.holds(rules.unpinned_functions, ENGINE, planted=[
            "double s = std::sin(x);\n", "double s = std :: sin (x);\n", "double s = std::\n  sin(x);\n",
            "double s = sin(x);\n", "double s = ::sin(x);\n", "double s = (sin)(x) + cos(x);\n", "float s = sinf(x);\n",
            "using std::sin;\n", "using namespace std;\n", "using namespace pinned;\n", "auto f = &std::exp;\n",
            "std::transform(a, b, c, ::sqrt), d = ::exp(e);\n", "double p = std::pow(x, 2);\n",
            "float p = std::powf(x, 2);\n",
            "double h = std::hypot(x, y, z);\n", "double h = hypot(x, y);\n", "double a = std::atan(x);\n",
            "double a = std::acosh(x);\n", "double l = std::log10(x);\n", "double l = std::log1p(x);\n",
            "sincos(x, &s, &c);\n",
            "double e = std::erf(x);\n", "double g = std::tgamma(x);\n", "double b = std::cyl_bessel_j(0, x);\n",
            "double b = std::beta(1, x);\n", "double s = __builtin_sin(x);\n", "#include <complex>\n",
            "#include <valarray>\n",
            "auto z = std::polar(1.0, x);\n", "v.array().sin();\n", "v.array().exp().sum();\n", "v.array().pow(3);\n",
            "Eigen::numext::sin(x);\n", "Eigen::AngleAxisd turn(x, axis);\n", "using Turn = AngleAxis<double>;\n",
            "Eigen::Rotation2Dd r(x);\n", "q.slerp(0.5, p);\n", "m.eulerAngles(0, 1, 2);\n", "a.angularDistance(b);\n",
            "solver.computeDirect(m);\n", "m.exp();\n", "#include <unsupported/Eigen/MatrixFunctions>\n",
            ("engine/script/a.cpp", "double s = std::sin(x);\n"),
            ("engine/geometry/a.cpp", "double s = std::sin(x);\n"),
            ("engine/new_folder/a.cpp", "double s = std::sin(x);\n"),
            ("engine/voxel/limits.cpp", "int calls_nothing;\n"),
        ], harmless=[
            "double s = pinned::sin(x) + std::sqrt(y) + std::abs(z);\n", "const Quaterniond q = slerp(a, b, s);\n",
            "#include <cmath>\n", "// std::sin(x)\n", 'fail("sin(x) is 0");\n', "verisim_lua_sin(x);\n",
            ("engine/voxel/limits.cpp", "double l = std::log10(x);\n"),
        ])

    def test_tests_write_into_folders_of_their_own(self):
        self.holds(rules.folders_named_by_a_test, sources("tests", "bench"), planted=[
            ("tests/base/a.cpp", 'auto p = fs::temp_directory_path() / "mine";\n'),
            ("tests/base/a.cpp", "auto p = testing::TempDir();\n"), ("tests/base/a.cpp", 'std::ofstream("/tmp/mine");\n'),
            ("bench/a.cpp", "mkdtemp(name);\n"),
        ], harmless=[
            ("tests/base/a.cpp", "// temp_directory_path\n"), ("tests/base/a.cpp", "const Folder folder;\n"),
            ("tests/support/folder.hpp", "mkdtemp(name);\n"),
        ])

    def test_files_are_opened_in_few_places(self):
        self.holds(rules.files_opened_elsewhere, ENGINE, planted=[
            "std::ifstream in(path);\n", "std::fstream f;\n", "std::basic_ifstream<char> in;\n", "#include <fstream>\n",
            "std::filebuf b;\n", 'auto* f = std::fopen(path, "r");\n', 'fopen(path, "r");\n', "auto f = &fopen;\n",
            'freopen(path, "r", stdin);\n', "int d = ::open(path, O_RDONLY);\n", "int d = open(path.c_str(), O_RDONLY);\n",
            "int d = openat(at, path, 0);\n", "int d = ::open64(path, 0);\n", "int d = ::creat(path, 0);\n",
            "H5Fopen(path, H5F_ACC_RDONLY, access);\n", "H5Fcreate(path, 0, 0, 0);\n", "reader.ReadFile(path);\n",
            "mkstemp(name);\n", "luaL_loadfile(L, name);\n", "fs::directory_iterator it(path);\n", "opendir(path);\n",
        ], harmless=[
            "void open();\n", "implementation_->open();\n", "file.open(path, mode);\n", "// std::ifstream\n", '"fopen"\n',
            "is_open(a, b);\n", "importer.ReadFileFromMemory(a, b);\n",
            ("engine/record/run_file.cpp", "H5Fopen(path, 0, 0);\n"),
        ])

    def test_every_function_of_a_header_is_called(self):
        self.holds(rules.functions_nobody_calls, ENGINE, planted=[
            ("engine/base/a.hpp", "void lonely();\n"),
            ("engine/base/a.hpp", "struct A {\n  int lonely() const { return 1; }\n};\n"),
            ("engine/base/a.hpp", "[[nodiscard]] std::vector<int> lonely(const A& a,\n    int b);\n"),
            ("engine/base/a.hpp", "// lonely() does it\nconst A& lonely();\nvoid lonely(int a);\n"),
            ("engine/base/a.hpp", "template <class T>\nT* lonely(T* t) {\n  return t;\n}\n"),
            ("engine/base/a.hpp", "int gap_at_end();\nint n = gap_at_end();\n"),
        ], harmless=[
            ("engine/base/a.hpp", "int used();\nstruct A {\n  int n = used();\n};\n"),
            ("engine/base/a.hpp", "int used();\n#define USE used()\n"),
            ("engine/base/a.hpp", "int used() { return 1; }\nstatic_assert(used() == 1);\n"),
            ("engine/base/a.hpp", "int gap_at_end();\n"), ("engine/base/a.cpp", "void lonely() {}\n"),
        ])

    def test_no_file_is_longer_than_500_lines(self):
        texts = {f: (ROOT / f).read_text() for f in documents.files() if f.endswith((".md", *documents.WRITTEN))}
        self.assertGreater(len(texts), len(ALL))
        self.holds(rules.long_files, texts, planted=["\n" * 501, "x\n" * 500 + "x", ("tests/lint/a.py", "\n" * 501)],
                   harmless=["\n" * 500])

    def test_no_function_is_longer_than_a_screen_but_those_that_may_only_become_shorter(self):
        long = "  ++n;\n" * rules.LINES_OF_A_SCREEN
        row = next(iter(rules.LONGER_THAN_A_SCREEN))
        path, name = row.split(": ")
        self.holds(rules.long_functions, ALL, planted=[
            f"void f() {{\n{long}}}\n",
            f"namespace a {{\nclass B {{\n  int f() const noexcept {{\n{long}  }}\n}};\n}}\n",
            f"auto f(int a)\n    -> std::vector<int> {{\n{long}}}\n", f"B::B(int a) : a_{{a}}, b_(a) {{\n{long}}}\n",
            f"template <class T>\nrequires(sizeof(T) > 1)\nvoid f(T t) {{\n{long}}}\n", f"TEST(A, B) {{\n{long}}}\n",
            f"bool operator==(const A& a, const A& b) {{\n{long}}}\n", f"const auto f = [](int a) {{\n{long}}};\n",
            f'void f() {{\n  const char* s = "}}";  // }}\n{long}}}\n', f"void f() {{\n  if (a) {{\n{long}  }}\n}}\n",
            (path, f"void {name}() {{\n{'  ++n;' * 3}}}\n"),
            (path, f"void {name}() {{\n" + "  ++n;\n" * rules.LONGER_THAN_A_SCREEN[row] + "}\n"),
        ], harmless=[
            "void f() {\n" + "  ++n;\n" * (rules.LINES_OF_A_SCREEN - 2) + "}\n",
            f"constexpr int kTable[] = {{\n{long}}};\n", f"namespace a {{\n{long}}}\n", f"struct A {{\n{long}}};\n",
        ])

    def test_the_documents_name_only_what_exists(self):
        self.holds(documents.names_of_nothing, documents.documents(), planted=[
            ("README.md", "see `engine/nothing.hpp`"), ("README.md", "see `engine/base/pose.hpp engine/nothing.hpp`"),
            ("README.md", "see `engine/nothing`"), ("README.md", "see `engine/script/nothing_*.cpp`"),
            ("README.md", "see `nothing.hpp`"), ("README.md", "see `nothing_test`"),
            ("README.md", "see `reports/nothing.md`,"),
            ("engine/voxel/README.md", "see `coupling.hpp`"), ("engine/base/README.md", "its test `nothing_test`"),
            ("engine/base/README.md", "```\n`\n```\nsee `nothing.hpp`"),
        ], harmless=[("README.md", "see `engine/base/pose.hpp`, `engine/script/words_*.cpp` and `rules_test`"),
                     ("engine/dynamics/README.md", "open `coupling.hpp`, then `base/pose.hpp`"),
                     ("engine/voxel/README.md", "of `engine/geometry` see `mesh.hpp`")])

    def test_the_map_leads_to_what_it_says(self):
        table = "| what | where | look for |\n|---|---|---|\n"
        self.holds(documents.rows_that_lead_astray, documents.documents(), planted=[
            ("ARCHITECTURE.md", table + "| the order | `engine/simulation/step.cpp` | `Simulation::tread` |\n"),
            ("ARCHITECTURE.md", table + "| the order | `engine/base/pose.hpp` | `Simulation::step` |\n"),
            ("ARCHITECTURE.md", table + "| a scene | `engine/simulation/scene.hpp` | `Scene`, `SceneOfTheCrime` |\n"),
            ("ARCHITECTURE.md", table + "| flags | `cmake/flags.cmake` | `verisim_core_variants` |\n"),
        ], harmless=[
            ("ARCHITECTURE.md", table + "| a scene | `engine/simulation/scene.hpp` | `Scene`: plain data |\n")])

    def test_the_documents_use_only_words_of_the_code(self):
        self.holds(documents.words_of_nothing, documents.documents(), planted=[
            ("README.md", "`Simulation::tread`"), ("README.md", "`nothing_of_that_name`"),
            ("README.md", "`/cost/nothings`"),
            ("README.md", "`body:setNothing`"),
        ], harmless=[("README.md", "`/cost/lookups`, `body:setHybridEnabled`, `MAY_INCLUDE`")])

    def test_comments_name_only_files_that_exist(self):
        self.holds(documents.comments_that_name_nothing, ALL, planted=[
            "int a;  // see engine/nothing.hpp\n", "/* engine/base/pose.hpp, tests/base/nothing_test.cpp */\n",
            "/// What bench/nothing does.\n",
        ], harmless=["// engine/base/pose.hpp; engine/script/words_*.cpp\n", 'fail("engine/nothing.hpp");\n'])


class SourceText(unittest.TestCase):
    def test_comments_and_literals_are_told_apart(self):
        text = 'a("// no"); // yes\nb(R"x(/* no */ ")x", \'"\', 1\'000); /* and\nyes */ c();\n'
        self.assertEqual(comments_of(text), ["// yes", "/* and\nyes */"])
        self.assertEqual(includes('#include <a>  // <b>\n"#include <c>"\n'), ["<a>"])

    def test_functions_have_names_and_lengths(self):
        text = ("namespace a {\nstruct B : C {\n  B() : x{1}, y(2) {\n    f();\n  }\n  int x = {};\n};\n"
                "int B::f(\n    int z) {\n  if (z) { return 1; }\n  return 2;\n}\nint t[] = {1,\n2};\n}\n")
        self.assertEqual(functions(text), [("B", 3), ("B::f", 5)])


if __name__ == "__main__":
    unittest.main()
