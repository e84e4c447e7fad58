// A sandbox with nothing but the standard library, and the three ways in which a test asks it.
#pragma once

#include <string>
#include <vector>

#include "engine/base/random.hpp"
#include "engine/script/sandbox.hpp"

namespace verisim::script {

class BareSandbox : public Sandbox {
 public:
  explicit BareSandbox(std::size_t memory_limit = std::size_t{16} << 20) : Sandbox("test.lua", memory_limit) {}
  void print(const std::string& line) override { printed.push_back(line); }
  [[nodiscard]] double clock() const override { return 1.5; }
  [[nodiscard]] double random() override { return RandomStream(7, stream).uniform(drawn++); }
  void seed_random(double seed) override {
    stream = fmt::format("script {}", seed);
    drawn = 0;
  }
  void stop() override { stopped = true; }

  /// Runs `text`; the failure's text, or an empty string.
  std::string failure_of(const std::string& text, std::uint64_t units = 10'000'000) {
    allow(units);
    auto failure = load(lua(), "test.lua", text);
    if (!failure) failure = call(lua(), 0, 0);
    return failure ? failure->text : std::string{};
  }
  /// The value of an expression as text, or the failure.
  std::string value_of(const std::string& expression) {
    const std::string failure = failure_of("__value = tostring(" + expression + ")");
    if (!failure.empty()) return failure;
    lua_getglobal(lua(), "__value");
    std::string value = lua_tostring(lua(), -1);
    lua_pop(lua(), 1);
    return value;
  }

  std::vector<std::string> printed;
  std::string stream = "script";
  std::uint64_t drawn = 0;
  bool stopped = false;
};

}  // namespace verisim::script
