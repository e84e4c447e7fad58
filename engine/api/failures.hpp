// Errors of the engine as what users of the library catch.
#pragma once

#include <string>
#include <vector>

#include <verisim/failure.hpp>
#include "engine/base/error.hpp"

namespace verisim {

/// What `work` returns; an Error that it throws becomes a Failure.
template <typename Work>
auto with_failures(Work work) {
  try {
    return work();
  } catch (const Error& error) {
    throw Failure(error.exit_code(), error.what());
  }
}

/// Failure of the caller (Error(usage)) if `text` is not one line of UTF-8; `what` is what it is called.
void check_line(const std::string& what, const std::string& text);

/// "no body is called 'pni'; did you mean 'pin'?"
[[nodiscard]] std::string unknown_name(const std::string& what, const std::string& name,
                                       const std::vector<std::string>& known);

}  // namespace verisim
