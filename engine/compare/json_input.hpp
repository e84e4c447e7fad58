// JSON that a user gives: what cannot be read is told with its line.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "engine/base/error.hpp"
#include "engine/base/text.hpp"

namespace verisim::compare {

/// Error(input): "FILE:12: is no JSON, or the file ends there; ADVICE".
[[nodiscard]] inline nlohmann::json parse_input(const std::string& file, const std::string& text,
                                                const std::string& advice) {
  try {
    return nlohmann::json::parse(text);
  } catch (const nlohmann::json::parse_error& error) {
    fail(ErrorKind::input, "{}:{}: is no JSON, or the file ends there; {}", file, line_of_byte(text, error.byte),
         advice);
  }
}

}  // namespace verisim::compare
