// Traces: recorded or synthesized input (haptic, wii, encoder), as CSV or HDF5 with the same fields (INTERFACES section
// 4). SI units; quaternions x, y, z, w.
//
// The HDF5 form: attributes `kind`, `rate_hz`, `source` and the further keys on "/"; one dataset of shape [N] per
// column, named as the column ("t", "px" …). Columns are found by name; their order does not matter.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "engine/base/error.hpp"

namespace verisim {

/// A trace as a table of numbers.
struct Trace {
  std::string kind;                          ///< "haptic", "wii", "encoder"
  double rate_hz = 0;                        ///< nominal; 0: not known, as that of one sample
  std::string source;                        ///< who recorded what with what
  std::map<std::string, std::string> extra;  ///< further "# key: value" lines (leds, fov_deg, remote_pose …)
  std::vector<std::string> columns;          ///< "t" first
  std::vector<double> values;                ///< (rows, columns), row-major
  [[nodiscard]] std::size_t rows() const { return columns.empty() ? 0 : values.size() / columns.size(); }
  /// @pre row < rows(), and there is such a column
  [[nodiscard]] double at(std::size_t row, std::size_t column) const {
    VERISIM_ASSERT(column < columns.size());
    VERISIM_ASSERT(row * columns.size() + column < values.size());
    return values[row * columns.size() + column];
  }
  /// Index of a column, or -1.
  [[nodiscard]] int column(const std::string& name) const;
};

struct TraceLimits {
  double max_gap = 0.1;     ///< s; a longer gap is an error …
  bool allow_gaps = false;  ///< … unless allowed
  bool resort = false;      ///< sort rows by time first (--resort)
};

/// Parses a trace from its bytes; the format is found from the content. `name` is for the messages, which give the
/// line: Error(input) for time going backwards or repeating, NaN or infinity, a quaternion that cannot be normalised,
/// missing columns, a wrong number of fields, an unknown kind, `expected_kind` (if not empty) not met, no samples.
/// Quaternions of a length between 0.5 and 2 are normalised; those that are so to 1e-14 stay as they are, bit by bit.
/// About 10 ns a number.
[[nodiscard]] Trace parse_trace(const std::string& name, const std::string& content, const std::string& expected_kind,
                                const TraceLimits& limits);

/// Writes CSV or HDF5, by the extension of `path` (.csv, .h5), in one step: never half a file. What is read back is
/// equal to the bit; CSV numbers are the shortest that say so (at most 17 digits). Error(io); Error(usage) for another
/// extension. @pre the trace has columns, and a value of each for every row
void write_trace(const std::string& path, const Trace& trace);

/// One mapping of `trace convert`: target column = scale * source column + offset.
struct ColumnMapping {
  std::string target;
  std::string source;  ///< name, or number from 1; empty: constant
  double scale = 1;
  double offset = 0;
};
/// "px=2*0.075+0.1": a column by number (from 1) or name, then *SCALE, then +OFFSET or -OFFSET, each only if needed.
/// "pz=:0.25": a constant. A name that holds '*', '+' or '-' cannot be written here: use its number. Error(usage).
[[nodiscard]] ColumnMapping parse_mapping(const std::string& text);

struct ConvertOptions {
  std::string kind = "haptic";
  double rate_hz = 0;  ///< of the file's rows; > 0: time is row / rate, whatever the file says
  std::string time_column =
      {};                 ///< else this column (name or number), with time_scale, shifted to begin at 0, to whole ns
  double time_scale = 1;  ///< s per unit of that column
  int every = 1;          ///< take rows 0, n, 2n … (exact decimation)
  int skip_rows = 0;      ///< lines before the column names or the first number
  bool cumulative =
      false;  ///< encoder columns are increments of each row: summed, also over rows not taken, and rounded
  std::string source = {};
  std::vector<ColumnMapping> mappings = {};
};
/// A foreign CSV to a trace: separated by semicolons, commas, tabs or blanks; with or without column names; byte order
/// mark, quotes and lines beginning with '#' or '%' accepted. Of a group of which only some are mapped (px py pz;
/// fx fy fz; tx ty tz) the others are 0; without a mapped quaternion it is the identity. A row in which a mapped field
/// is empty (the recorder lost it) is left out and counted in extra["rows_left_out"]; gaps are judged when the trace is
/// used. Error(input) with file and line; Error(usage) for mappings that make no sense.
[[nodiscard]] Trace convert_csv(const std::string& name, const std::string& content, const ConvertOptions& options);

}  // namespace verisim
