// The list of the dissertation's results that this program measures again (ORACLES section 1).
#pragma once

#include <span>
#include <vector>

#include "engine/reproduce/row.hpp"

namespace verisim::reproduce {

/// One result: measures and returns its rows. Error as of whatever it runs.
struct Reproduction {
  const char* id;
  const char* what;  ///< a few words for progress and help
  std::vector<Row> (*measure)(const Workshop&);
};

/// In the order in which they run and are printed.
[[nodiscard]] std::span<const Reproduction> reproductions();

// One file each.
[[nodiscard]] std::vector<Row> r1_overruns(const Workshop& workshop);
[[nodiscard]] std::vector<Row> r2_passes(const Workshop& workshop);
[[nodiscard]] std::vector<Row> r3_collisions(const Workshop& workshop);
[[nodiscard]] std::vector<Row> r4_recognition(const Workshop& workshop);
[[nodiscard]] std::vector<Row> r5_blending(const Workshop& workshop);
[[nodiscard]] std::vector<Row> r6_bubble_laws(const Workshop& workshop);
[[nodiscard]] std::vector<Row> r7_coverage(const Workshop& workshop);
[[nodiscard]] std::vector<Row> r8_firmware(const Workshop& workshop);
[[nodiscard]] std::vector<Row> r9_conflicts(const Workshop& workshop);
[[nodiscard]] std::vector<Row> r10_stickiness(const Workshop& workshop);
[[nodiscard]] std::vector<Row> r11_transparency(const Workshop& workshop);

/// The rows as a table for a terminal: figures aligned, the reason below each.
[[nodiscard]] std::string table_of(const std::vector<Row>& rows);

}  // namespace verisim::reproduce
