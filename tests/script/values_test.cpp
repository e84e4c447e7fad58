// Objects of the engine that scripts hold are taken apart, wherever the script ends.
#include "engine/script/values.hpp"

#include <gtest/gtest.h>

#include "tests/length.hpp"
#include "tests/script/bare_sandbox.hpp"

namespace verisim::script {
namespace values_test {
struct Counted {
  static inline int alive = 0;
  Counted() { ++alive; }
  Counted(const Counted&) { ++alive; }
  Counted(Counted&&) noexcept { ++alive; }
  Counted& operator=(const Counted&) = default;
  Counted& operator=(Counted&&) = default;
  ~Counted() { --alive; }
};
}  // namespace values_test
template <>
inline constexpr const char* kTypeName<values_test::Counted> = "counted";

namespace values_test {
namespace {

int make_counted(lua_State* L) {
  push(L, Counted());
  return 1;
}

struct Made {
  std::string failure;
  std::string metatable;  ///< what a script sees of it
};

/// Makes objects that become garbage, for as long as it may.
Made make_many(std::uint64_t units, std::size_t memory) {
  BareSandbox sandbox(memory);
  set_global<make_counted, Charge::call>(sandbox.lua(), "counted");
  Made made;
  made.failure =
      sandbox.failure_of("local t = {} for i = 1, 1e9 do t[i % 50] = { counted(), ('x'):rep(i % 97) } end", units);
  made.metatable = sandbox.value_of("getmetatable(counted())");
  return made;
}

TEST(Values, AreTakenApartWhereverTheAllowanceEnds) {
  std::set<std::string> metatables;
  for (std::uint64_t units = 1; units < 60'000; units += test::by_length(370U, 37U, 7U)) {
    metatables.insert(make_many(units, std::size_t{16} << 20).metatable);
    ASSERT_EQ(Counted::alive, 0) << "after " << units << " units";
  }
  EXPECT_EQ(metatables, std::set<std::string>{"counted"});
}

TEST(Values, AreTakenApartWhereverTheMemoryEnds) {
  int ended_by_memory = 0;
  for (std::size_t memory = 60'000; memory < 130'000; memory += test::by_length(1370U, 137U, 37U)) {
    try {
      if (make_many(10'000'000, memory).failure.find("of memory") != std::string::npos) ++ended_by_memory;
    } catch (const Error&) {  // too small for Lua itself
    }
    ASSERT_EQ(Counted::alive, 0) << "with " << memory << " bytes";
  }
  EXPECT_GT(ended_by_memory, test::by_length(1, 10, 10));
}

}  // namespace
}  // namespace values_test
}  // namespace verisim::script
