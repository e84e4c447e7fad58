// Expecting that a broken promise is found at the door: the program ends and names the condition.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "engine/base/error.hpp"

namespace verisim::test {

/// A regular expression for what assertion_failed prints about this condition.
[[nodiscard]] inline std::string broken_promise(const std::string& condition) {
  std::string expression = "broken promise at [^\n]*: ";
  for (const char c : condition) {
    if (std::string(".[{}()\\*+?|^$").find(c) != std::string::npos) expression += '\\';
    expression += c;
  }
  return expression + "\n";
}

}  // namespace verisim::test

/// The statement must end at VERISIM_ASSERT(condition), whose whole text is given.
#define EXPECT_BROKEN(statement, condition) EXPECT_DEATH((void)(statement), ::verisim::test::broken_promise(condition))
