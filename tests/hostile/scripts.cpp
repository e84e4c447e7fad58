// Hostile scripts: seeded programs over every function that a script can reach, with the worst arguments, nested
// pcalls, coroutines, metatables, errors and compiled texts. hostile_scripts COUNT [LONG_COUNT [FIRST_SEED]]
//
// Promised of each: it ends, with a result or one line of error; its processor time is that of its work (20 ns a unit)
// and 2 s; the process never takes more than the script's memory and 64 MB. A program is its seed: the same on every
// machine.
#include <sys/resource.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <map>
#include <optional>
#include <string>

#include "engine/base/random.hpp"
#include "engine/base/text.hpp"
#include "engine/script/script_state.hpp"
#include "tests/length.hpp"
#include "tests/script/every_function.hpp"

namespace verisim::script {
namespace {

constexpr std::uint64_t kUnits = 300'000;                      // some 3 ms
constexpr std::size_t kMemory = std::size_t{24} << 20;         // bytes
constexpr std::size_t kOutside = std::size_t{64} * 1'000'000;  // bytes
constexpr double kSecondsMax = test::kSanitized ? 60 : 2;
constexpr bool kMemoryIsTheScripts = !test::kSanitized;  // AddressSanitizer keeps what was freed
constexpr std::size_t kFrames = 2;
constexpr std::size_t kActionsMax = 2;  // each has an allowance of its own in each frame, some 0.1 s

// What programs are made of. F: every function that can be reached; V: values, some of them large.
constexpr const char* kPrelude = R"lua(
  local big = ("x"):rep(3e5)
  local emptied = {} for i = 1, 3000 do emptied[i + 0.5] = true end for i = 1, 2999 do emptied[i + 0.5] = nil end
  local list = {} for i = 1, 3000 do list[i] = i end
  local loop = {} loop[1] = loop loop.loop = loop
  local strange = {}
  setmetatable(strange, { __index = strange, __call = function(...) return ... end, __tostring = function() return big end,
    __lt = function() return true end, __le = error, __eq = function() return true end, __concat = function(a, b) return big end,
    __newindex = function(t, k, v) rawset(t, k, v) end, __unm = pcall, __add = error, __len = print, __metatable = "strange" })
  local shared = 1 for i = 1, 6 do local row = {} for j = 1, 100 do row[j] = shared end shared = row end
  V = { 0, -1, 1, 2, 100, 1e9, -2147483648, 2147483647, 2^53, 1e308, -1e308, 0/0, 1/0, 0.5, true, false,
    "", "a", "\0\255\27[31m", big, ("1"):rep(3e5), ("("):rep(300), "[" .. big .. "]*", ".-.-.-b", "%b()", "%f[%a]", "%99.99f",
    ("%s"):rep(50), "return " .. ("{"):rep(190), "while true do end", "return 1", "name", "../../etc/passwd", "\"\\'\n",
    {}, list, emptied, loop, strange, shared, { name = "a", loop }, { 1, 2, 3 }, { position = { 1, 2, 3 } }, { x = shared },
    print, error, pcall, function() while true do end end, function(...) return ... end, function() error(loop) end,
    function() error(big) end, function() coroutine.yield(big) end, coroutine.create(function(...) coroutine.yield(...) end),
    coroutine.create(function() error() end), coroutine.wrap(function(...) while true do coroutine.yield(...) end end),
    osg.Vec3(1, 2, 3), osg.Quat(), osg.Matrix(), Solid.box{1, 1, 1}, Group{}, Plane(), FeatureSet(),
    Devices.Hand{ path = {{0, 0, 0}} }, simulation, runbuf, Actions, math, string, table, osg, _G })lua";

class Generator {
 public:
  Generator(std::uint64_t seed, std::size_t functions, std::size_t values)
      : stream_(seed, "hostile scripts"), functions_(functions), values_(values) {}

  std::string program() {
    std::string text = "local F, V, t = F, V, {} ";
    const int count = 1 + draw(6);
    for (int i = 0; i < count; ++i) text += statement(3);
    return text;
  }

 private:
  std::string value() { return fmt::format("V[{}]", 1 + draw(static_cast<int>(values_))); }

  std::string expression(int depth) {
    if (depth == 0) return value();
    switch (draw(14)) {
      case 0:
        return call(depth - 1);
      case 1:
        return fmt::format("({} .. {})", expression(depth - 1), expression(depth - 1));
      case 2:
        return fmt::format("#({})", expression(depth - 1));
      case 3:
        return fmt::format("({} {} {})", expression(depth - 1),
                           pick({"+", "*", "^", "%", "<", "<=", "==", "and", "or"}), expression(depth - 1));
      case 4:
        return fmt::format("({})[{}]", expression(depth - 1), expression(depth - 1));
      case 5:
        return fmt::format("(function(...) {} return ... end)", statement(depth - 1));
      case 6:
        return fmt::format("setmetatable({{}}, {{ {} = {} }})",
                           pick({"__index", "__newindex", "__call", "__tostring", "__concat", "__lt", "__eq", "__gc",
                                 "__mode", "__metatable", "__unm", "__add"}),
                           expression(depth - 1));
      case 7:
        return fmt::format("{{ {}, {}, x = {} }}", expression(depth - 1), expression(depth - 1), expression(depth - 1));
      default:
        return value();
    }
  }

  std::string call(int depth) {
    std::string arguments;
    const int count = draw(5);
    for (int i = 0; i < count; ++i) arguments += (i == 0 ? "" : ", ") + expression(depth);
    return fmt::format("F[{}]({})", 1 + draw(static_cast<int>(functions_)), arguments);
  }

  std::string statement(int depth) {
    if (depth == 0) return fmt::format("pcall(function() return {} end) ", call(0));
    const int next = depth - 1;
    switch (draw(14)) {
      case 0:
        return fmt::format("for i = 1, {} do {} end ", pick({"10", "1e3", "1e9"}), statement(next));
      case 1:
        return fmt::format("while true do {} end ", statement(next));
      case 2:
        return fmt::format("xpcall(function() {} end, function(e) {} return e end) ", statement(next), statement(next));
      case 3:
        return fmt::format("pcall(coroutine.wrap(function() {} coroutine.yield() end)) ", statement(next));
      case 4:
        return fmt::format("coroutine.resume(coroutine.create(function() {} end)) ", statement(next));
      case 5:
        return fmt::format("pcall(function() for k, v in pairs({}) do {} end end) ", expression(next), statement(next));
      case 6:
        return fmt::format("pcall(function() t[{}] = {} end) ", expression(next), expression(next));
      case 7:
        return fmt::format("do local function f() {} return f() end pcall(f) end ", statement(next));
      case 8:
        return fmt::format("pcall(loadstring, {}) ", expression(next));
      case 9:
        return fmt::format("pcall(function() error({}) end) ", expression(next));
      case 10:
        return fmt::format("Actions.addFrameAction(function() {} Actions.waitForRedraw() end) ", statement(next));
      case 11:
        return "local _ = " + call(next) + " ";  // its error ends the program
      default:
        return fmt::format("pcall(function() return {} end) ", call(next));
    }
  }

  template <std::size_t N>
  const char* pick(const char* const (&choices)[N]) {
    return choices[static_cast<std::size_t>(draw(static_cast<int>(N)))];
  }
  int draw(int below) { return static_cast<int>(stream_.uniform(drawn_++) * below); }

  RandomStream stream_;
  std::uint64_t drawn_ = 0;
  std::size_t functions_;
  std::size_t values_;
};

double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// The most that this process ever took.
std::size_t most_resident() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::size_t>(usage.ru_maxrss) * 1024;
}

const char* kind_of(const std::optional<LuaFailure>& failure) {
  if (!failure) return "ok";
  if (failure->text.find("without coming to an end") != std::string::npos) return "work limit";
  if (failure->text.find("MiB of memory") != std::string::npos) return "memory limit";
  return "script error";
}

class Program {
 public:
  explicit Program(std::uint64_t seed) : inputs_(Inputs::live("/nowhere", {})), state_(options(), inputs_) {
    lua_State* L = state_.lua();
    state_.allow(1'000'000'000);
    load(kPrelude, 0);
    load(kSampleValues, 1);
    FunctionWalk walk(L);
    walk.visit("sample");
    lua_newtable(L);
    int i = 0;
    for (const ReachedFunction& function : walk.functions()) {
      lua_rawgeti(L, LUA_REGISTRYINDEX, function.reference);
      lua_rawseti(L, -2, ++i);
    }
    lua_setglobal(L, "F");
    lua_getglobal(L, "V");
    const std::size_t values = lua_objlen(L, -1);
    lua_settop(L, 0);
    text_ = Generator(seed, walk.functions().size(), values).program();
  }

  /// How it ended.
  std::string run() {
    lua_State* L = state_.lua();
    state_.allow(kUnits);
    auto failure = state_.load(L, "hostile.lua", text_);
    if (!failure) failure = state_.call(L, 0, 0);
    const std::string kind = kind_of(failure);
    if (failure && !line_fault(failure->text).empty()) return "BROKEN: the error is no line: " + shown(failure->text);
    for (std::size_t frame = 0; frame < kFrames && state_.actions.count() <= kActionsMax; ++frame)
      state_.actions.update(60);
    return kind;
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  static ScenarioOptions options() {
    ScenarioOptions options;
    options.path = "/nowhere/hostile.lua";
    options.memory_limit = kMemory;
    return options;
  }
  void load(const char* text, int results) {
    auto failure = state_.load(state_.lua(), "prelude.lua", text);
    if (!failure) failure = state_.call(state_.lua(), 0, results);
    if (failure) throw Error(ErrorKind::input, failure->text);
  }

  Inputs inputs_;
  ScriptState state_;
  std::string text_;
};

/// Empty, or what was broken.
std::string broken_promise(double seconds, std::uint64_t units, std::size_t resident_before) {
  constexpr double kSecondsPerUnit = 20e-9;
  constexpr std::uint64_t kAllowed = kUnits + kFrames * kActionsMax * kFrameWork;
  if (seconds > kSecondsMax + kSecondsPerUnit * static_cast<double>(kAllowed))
    return fmt::format("took {:.1f} s for {} units", seconds, units);
  const std::size_t resident = most_resident();
  if (kMemoryIsTheScripts && resident > resident_before + kMemory + kOutside)
    return fmt::format("took {} MB of memory", (resident - resident_before) / 1'000'000);
  return {};
}

int run_all(std::uint64_t count, std::uint64_t first_seed) {
  std::map<std::string, std::uint64_t> kinds;
  const std::size_t resident_before = most_resident();
  double slowest = 0;
  for (std::uint64_t seed = first_seed; seed < first_seed + count; ++seed) {
    Program program(seed);
    const double begin = processor_seconds();
    const std::uint64_t units_before = work.used;
    std::string kind;
    try {
      kind = program.run();
    } catch (const Error&) {
      kind = "script error";  // of an action, while no simulation runs that would take it as an event
    } catch (const std::exception& error) {
      kind = std::string("BROKEN: exception ") + error.what();
    }
    const double seconds = processor_seconds() - begin;
    slowest = std::max(slowest, seconds);
    const std::string broken =
        kind.rfind("BROKEN", 0) == 0 ? kind : broken_promise(seconds, work.used - units_before, resident_before);
    if (!broken.empty()) {
      std::printf("seed %llu: %s\n%s\n", static_cast<unsigned long long>(seed), broken.c_str(), program.text().c_str());
      return 1;
    }
    ++kinds[kind];
    if (count > 10'000 && (seed - first_seed) % 10'000 == 9'999) {
      std::printf("%llu programs\n", static_cast<unsigned long long>(seed - first_seed + 1));
      std::fflush(stdout);
    }
  }
  for (const auto& [kind, number] : kinds)
    std::printf("%-14s%llu\n", kind.c_str(), static_cast<unsigned long long>(number));
  std::printf("slowest       %.3f s\nmemory        %zu MB more than before\n", slowest,
              (most_resident() - resident_before) / 1'000'000);
  return 0;
}

}  // namespace
}  // namespace verisim::script

int main(int argc, char** argv) {
  const auto argument = [&](int i, std::uint64_t otherwise) {
    return argc > i ? std::strtoull(argv[i], nullptr, 10) : otherwise;
  };
  const std::uint64_t short_count = argument(1, 3000);
  if (std::getenv("HOSTILE_LOUD") == nullptr && std::freopen("/dev/null", "w", stderr) == nullptr)
    return 1;  // what programs print
  return verisim::script::run_all(
      verisim::test::by_length<std::uint64_t>(short_count / 4, short_count, argument(2, short_count)), argument(3, 1));
}
