// A comparison as people read it and as programs do.
#pragma once

#include <string>

#include "engine/base/json.hpp"
#include "engine/compare/comparison.hpp"

namespace verisim::compare {

/// Tables with a line for each figure, then the verdict with its reasons.
[[nodiscard]] std::string table_of(const Comparison& comparison);

/// What INTERFACES section 5 promises of `--json`, and what else the tables have.
[[nodiscard]] Json json_of(const Comparison& comparison);

}  // namespace verisim::compare
