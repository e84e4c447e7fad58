// The form of a trace: the columns of each kind and the conditions on the numbers. Used by both file formats, by
// conversion and by synthesis.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/record/trace.hpp"

namespace verisim {

/// Columns that come together or not at all.
struct ColumnGroup {
  std::vector<std::string> columns;
  bool required = false;
};

/// The groups of a kind, in the order of INTERFACES section 4. Error(input), naming the kinds, for an unknown one.
[[nodiscard]] const std::vector<ColumnGroup>& column_groups(const std::string& name, const std::string& kind);
[[nodiscard]] std::vector<std::string> known_columns(const std::string& name, const std::string& kind);

/// Where a row came from, for messages: "peg.csv:1042".
using RowPlace = std::function<std::string(std::size_t row)>;

/// Brings a freshly read trace into form (sorted if asked, quaternions normalised) or throws as parse_trace promises.
void check_trace(Trace& trace, const std::string& name, const std::string& expected_kind, const TraceLimits& limits,
                 const RowPlace& place);

// The two formats. Neither checks what check_trace checks.
[[nodiscard]] Trace read_trace_csv(const std::string& name, std::string_view content, RowPlace& place);
[[nodiscard]] Trace read_trace_hdf5(const std::string& name, const std::string& content);
[[nodiscard]] std::string trace_as_csv(const Trace& trace);
void write_trace_hdf5(const std::string& path, const Trace& trace);

}  // namespace verisim
