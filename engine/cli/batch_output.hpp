// What `verisim batch` and `batch merge` say at their end.
#pragma once

#include <string>

#include "engine/base/json.hpp"
#include "engine/batch/index.hpp"
#include "engine/batch/summary.hpp"

namespace verisim::cli {

/// As an index has it: figures of two versions need not agree.
[[nodiscard]] std::string program_version();

/// Counts and groups of a folder's index.
[[nodiscard]] Json json_of(batch::Index& index, const batch::Summary& summary, const std::string& folder);
[[nodiscard]] std::string table_of(batch::Index& index, const batch::Summary& summary, const std::string& folder);

/// 1 if some runs could not be done, and a line on stderr that says so.
[[nodiscard]] int exit_code_of(batch::Index& index, const std::string& folder);

}  // namespace verisim::cli
