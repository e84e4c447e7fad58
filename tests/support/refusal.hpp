// Expecting that bad input is refused as the style guide asks: kind `input`, and a text that names the culprit.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "engine/base/error.hpp"

namespace verisim::test {

/// `make()` must throw Error(input) whose text contains `wanted`.
template <typename Make>
void expect_refused(const Make& make, const std::string& wanted) {
  try {
    (void)make();
    ADD_FAILURE() << "taken, though a refusal with '" << wanted << "' was due";
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::input);
    EXPECT_NE(std::string(e.what()).find(wanted), std::string::npos) << e.what();
  }
}

}  // namespace verisim::test
