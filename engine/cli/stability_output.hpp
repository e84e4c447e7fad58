// What `verisim stability` prints and writes: tables, JSON, CSV, pictures.
#pragma once

#include <string>
#include <vector>

#include "engine/base/json.hpp"
#include "engine/stability/row.hpp"

namespace verisim::cli {

/// A row as one JSON object, and back. Numbers that are not finite are null.
[[nodiscard]] Json json_of(const stability::Row& row);
[[nodiscard]] stability::Row row_of(const Json& json);

/// A task with what it came to.
struct StabilityRow {
  stability::Task task;
  stability::Row row;
  double cpu_s = 0;  ///< what it took; for people only
};

/// {"definitions": …, "maps": …, "extremes": …, "ledgers": …, "failed": …} (INTERFACES section 5).
[[nodiscard]] Json json_of(const std::vector<StabilityRow>& rows);
/// The same for people.
[[nodiscard]] std::string tables_of(const std::vector<StabilityRow>& rows);
/// Rows of which something is promised that does not hold: a bound beyond its tolerance, a cell that theory
/// contradicts, a ledger, an extreme that fails without a word or gets no answer. An extreme that fails and is told of
/// by an event of its run keeps the one promise that there is.
[[nodiscard]] std::vector<std::string> broken_promises(const std::vector<StabilityRow>& rows);
/// Where write_folder writes, before the work begins: Error(io) for a file there that is not of its kind, unless
/// `force`.
void check_folder(const std::string& folder, bool force);
/// stability.json, maps.csv, extremes.csv, ledgers.csv and a picture for each map with cells. Error(io).
void write_folder(const std::string& folder, bool force, const std::vector<StabilityRow>& rows);

}  // namespace verisim::cli
