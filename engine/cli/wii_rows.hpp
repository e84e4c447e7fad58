// Rows of validation, whoever was judged: as JSON, and as files.
#pragma once

#include <string>
#include <vector>

#include "engine/base/json.hpp"
#include "engine/base/user_file.hpp"
#include "engine/cli/options.hpp"
#include "engine/wii/validate.hpp"

namespace verisim::cli {

/// What is not known (NaN) is null.
[[nodiscard]] Json row_json(const wii::ValidationRow& row);

/// FILE without its ending: plots are named after it.
[[nodiscard]] std::string stem_of(const OutOptions& out);
/// Before anything is computed: may FILE.csv and FILE.svg be written? Plots over time are looked at when written.
void check_row_files(const OutOptions& out, const std::vector<FileIdentity>& inputs);
/// FILE.csv with every figure and FILE.svg with all of them at a glance.
void write_row_files(const OutOptions& out, const std::vector<wii::ValidationRow>& rows,
                     const std::vector<FileIdentity>& inputs);

}  // namespace verisim::cli
