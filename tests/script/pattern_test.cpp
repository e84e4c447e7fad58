// string.find, match, gmatch, gsub: this project's bounded matcher against worked results of the Lua 5.1 manual, and
// against Lua's own matcher on random texts and patterns.
#include <gtest/gtest.h>

#include <string>

#include "engine/base/random.hpp"
#include "tests/script/bare_sandbox.hpp"

namespace verisim::script::pattern_test {
namespace {

TEST(Patterns, GiveTheResultsOfTheManual) {
  BareSandbox sandbox;
  const std::pair<const char*, const char*> cases[] = {
      {"('hello world'):gsub('(%w+)', '%1 %1')", "hello hello world world"},
      {"('hello world'):gsub('%w+', '%0 %0', 1)", "hello hello world"},
      {"('hello world from Lua'):gsub('(%w+)%s*(%w+)', '%2 %1')", "world hello Lua from"},
      {"('4+5 = $return 4+5$'):gsub('%$(.-)%$', function(s) return loadstring(s)() end)", "4+5 = 9"},
      {"('$name-$version.tar.gz'):gsub('%$(%w+)', {name = 'lua', version = '5.1'})", "lua-5.1.tar.gz"},
      {"('THE (quick) fox'):find('%((%a+)%)')", "5"},
      {"('f(a(b)c)d'):match('%b()')", "(a(b)c)"},
      {"('THE (quick) fox'):gsub('%f[%a]%a+', 'x')", "x (x) x"},
      {"('key = value'):match('^(%w+)%s*=%s*(%w+)$')", "key"},
      {"('  trim  '):match('^%s*(.-)%s*$')", "trim"},
      {"('abc'):find('b', 1, true)", "2"},
      {"('a.b'):find('.', 2, true)", "2"},
      {"('flaaap'):match('()aa()')", "3"},
      {"('[]]'):match('[]]+')", "]]"},
      {"('x^y'):match('[%^x]+')", "x^"},
      {"('2026-01-31'):match('%d+-(%d+)-%d+')", "01"},
      {"('aXb'):gsub('', '-')", "-a-X-b-"},
      {"('abab'):match('(ab)%1')", "ab"},
      {"('abc'):find('^b')", "nil"},
      {"('abc'):find('c', -1)", "3"},
  };
  for (const auto& [expression, expected] : cases)
    EXPECT_EQ(sandbox.value_of(std::string("(") + expression + ")"), expected) << expression;
}

TEST(Patterns, WalkThroughAllMatches) {
  BareSandbox sandbox;
  EXPECT_EQ(sandbox.failure_of("local t = {} for k, v in ('a=1, b=2'):gmatch('(%w+)=(%w+)') do t[#t + 1] = k .. v end "
                               "assert(table.concat(t, ';') == 'a1;b2')"),
            "");
  EXPECT_EQ(
      sandbox.failure_of("local n = 0 for w in ('one two'):gmatch('%a*') do n = n + 1 end assert(n >= 2 and n <= 4)"),
      "");
}

// Lua's own library with four quantifiers over 64 KiB would take hours (platform notes: 17.7 s for far less).
TEST(Patterns, ThatRunAwayAreStoppedWithAReason) {
  BareSandbox sandbox;
  const std::string failure = sandbox.failure_of("('a'):rep(65536):find('.-.-.-.-b')", 1'000'000'000);
  EXPECT_NE(failure.find("takes more than"), std::string::npos) << failure;
  EXPECT_EQ(failure.rfind("test.lua:1: ", 0), 0u) << failure;
}

TEST(Patterns, OfManyOptionalItemsAreStopped) {
  BareSandbox sandbox;
  EXPECT_NE(sandbox.failure_of("('a'):rep(40):find(('a?'):rep(40) .. ('a'):rep(41))", 1'000'000'000), "");
  EXPECT_NE(sandbox.failure_of("('a'):rep(1e5):find(('a?'):rep(1e5))").find("too complex"), std::string::npos);
}

TEST(Patterns, CannotBeUsedToRunForEverInSmallPieces) {
  BareSandbox sandbox;
  const std::string failure = sandbox.failure_of("local s = ('a'):rep(80) while true do s:find('.-.-b') end");
  EXPECT_NE(failure.find("without coming to an end"), std::string::npos) << failure;
}

TEST(Patterns, ThatAreMalformedAreRefused) {
  BareSandbox sandbox;
  for (const char* pattern : {"%", "[a", "[^", "(a", "a)", "%b", "%bx", "%f", "%1", "[%"})
    EXPECT_NE(sandbox.failure_of(std::string("('abc'):find('") + pattern + "', 1) ('(a'):match('" + pattern + "')"), "")
        << pattern;
}

// Lua's own matcher, from a plain state beside the sandbox.
class PlainLua {
 public:
  PlainLua() : L_(luaL_newstate()) { luaL_openlibs(L_); }
  ~PlainLua() { lua_close(L_); }
  PlainLua(const PlainLua&) = delete;
  PlainLua& operator=(const PlainLua&) = delete;
  std::string value_of(const std::string& expression) {
    if (luaL_dostring(L_, ("return tostring(" + expression + ")").c_str()) != 0) {
      lua_settop(L_, 0);
      return "error";
    }
    std::string value = lua_tostring(L_, -1);
    lua_settop(L_, 0);
    return value;
  }

 private:
  lua_State* L_;
};

TEST(Patterns, FindWhatLuasOwnMatcherFinds) {
  const std::string pieces[] = {"a",  "b", ".", "%a", "%A",   "[ab]",  "[^b]", "a*", "b-",     "a+", ".-",
                                "c?", "(", ")", "()", "%b()", "%f[a]", "$",    "^",  "[a-c]*", "%1", "%s"};
  const RandomStream random(1, "patterns");
  std::uint64_t drawn = 0;
  const auto pick = [&](std::uint64_t n) { return random.bits(drawn++) % n; };
  BareSandbox sandbox;
  PlainLua plain;
  int matched = 0;
  for (int i = 0; i < 5000; ++i) {
    std::string pattern, subject;
    for (std::uint64_t n = 1 + pick(5); n > 0; --n) pattern += pieces[pick(std::size(pieces))];
    for (std::uint64_t n = pick(8); n > 0; --n) subject += "abc ()"[pick(6)];
    const std::string wanted =
        plain.value_of("select(2, pcall(string.gsub, '" + subject + "', '" + pattern + "', '<%0>'))");
    std::string found = sandbox.value_of("select(2, pcall(string.gsub, '" + subject + "', '" + pattern + "', '<%0>'))");
    const bool wanted_error =
        wanted.find("malformed") != std::string::npos || wanted.find("invalid") != std::string::npos ||
        wanted.find("missing") != std::string::npos || wanted.find("unfinished") != std::string::npos;
    if (wanted_error) {
      EXPECT_NE(found.find("malformed"), std::string::npos)
          << subject << " | " << pattern << " | " << wanted << " | " << found;
    } else {
      EXPECT_EQ(found, wanted) << "'" << subject << "' | " << pattern;
      matched += wanted.find('<') != std::string::npos ? 1 : 0;
    }
  }
  EXPECT_GT(matched, 1000) << "too few patterns matched anything: this test would prove little";
}

}  // namespace
}  // namespace verisim::script::pattern_test
