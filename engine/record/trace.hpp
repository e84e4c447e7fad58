// Traces: recorded or synthesized input (haptic, wii, encoder), CSV or HDF5 with the same fields (INTERFACES section
// 4).
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace verisim {

/// A trace as a table of numbers.
struct Trace {
  std::string kind;                          ///< "haptic", "wii", "encoder"
  double rate_hz = 0;                        ///< nominal
  std::string source;                        ///< who recorded what with what
  std::map<std::string, std::string> extra;  ///< further "# key: value" lines (leds, fov_deg, remote_pose …)
  std::vector<std::string> columns;          ///< "t" first
  std::vector<double> values;                ///< (rows, columns), row-major
  [[nodiscard]] std::size_t rows() const { return columns.empty() ? 0 : values.size() / columns.size(); }
  [[nodiscard]] double at(std::size_t row, std::size_t column) const { return values[row * columns.size() + column]; }
  /// Index of a column, or -1.
  [[nodiscard]] int column(const std::string& name) const;
};

struct TraceLimits {
  double max_gap = 0.1;     ///< s; a longer gap is an error …
  bool allow_gaps = false;  ///< … unless allowed
  bool resort = false;      ///< sort rows by time first (--resort)
};

/// Parses a trace from its bytes; the format is found from the content. `name` is for the messages, which give the row:
/// Error(input) for time going backwards or repeating, NaN or infinity, a quaternion that cannot be normalised
/// (haptic), missing columns, a wrong number of fields, an unknown kind, `expected_kind` (if not empty) not met, no
/// samples.
[[nodiscard]] Trace parse_trace(const std::string& name, const std::string& content, const std::string& expected_kind,
                                const TraceLimits& limits);

/// Writes CSV (17 significant digits, exact round trip) or HDF5, by the extension of `path` (.csv, .h5). Error(io).
void write_trace(const std::string& path, const Trace& trace);

/// One mapping of `trace convert`: target column = scale * source column + offset.
/// "px=2*0.075+0.1": column number (from 1) or name, optional *scale, optional +offset; "pz=0.25" without a column:
/// constant "pz=:0.25".
struct ColumnMapping {
  std::string target;
  std::string source;  ///< name or 1-based number; empty: constant
  double scale = 1;
  double offset = 0;
};
[[nodiscard]] ColumnMapping parse_mapping(const std::string& text);

struct ConvertOptions {
  std::string kind = "haptic";
  double rate_hz = 0;       ///< > 0: time is row / rate, whatever the file says
  std::string time_column;  ///< else this column, with time_scale, shifted to begin at 0
  double time_scale = 1;
  int every = 1;            ///< take every n-th row (exact decimation)
  int skip_rows = 0;        ///< header rows before the column names or the first number
  bool cumulative = false;  ///< encoder columns are increments: sum them, rounded to whole counts
  std::string source;
  std::vector<ColumnMapping> mappings;
};
/// A foreign CSV (comma, semicolon, tab or blank separated; with or without header; byte order mark accepted) to a
/// trace.
[[nodiscard]] Trace convert_csv(const std::string& name, const std::string& content, const ConvertOptions& options);

}  // namespace verisim
