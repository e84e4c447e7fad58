// The recorded rows of a run beside those of a simulation that goes the same way again.
#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "engine/record/run_file.hpp"
#include "engine/simulation/simulation.hpp"

namespace verisim::cli {

/// Compares /state and /cost frame by frame, bit by bit. Of a file of format 1, whose hashes and work counts are of
/// other things, /state without its hash.
class StoredRun {
 public:
  /// Error(check_failed) if the file has other columns than the simulation.
  StoredRun(const RunFile& file, const Simulation& simulation);

  /// "frame 1201, /state/body/pin/twist[3]: stored 3f68000000000001, simulated 3f68000000000000", or empty.
  /// @pre frames are asked for one after the other, as simulated
  [[nodiscard]] std::string difference_in_frame(std::size_t frame, std::span<const std::byte> row,
                                                const Simulation& simulation);
  /// Of /state/pairs, when all frames have been simulated.
  [[nodiscard]] std::string difference_in_pairs(const Simulation& simulation) const;

 private:
  struct Stored {
    Column column;
    std::vector<std::byte> bytes;
    std::vector<std::size_t> row_of_frame;  ///< empty: every frame has one
  };
  /// Format 1: a column per fact and pair. In which column of each the pair's value stands.
  struct DenseColumn {
    Column column;  ///< as in the table
    std::string pair;
    std::vector<std::byte> bytes;
  };
  void read_rows(const RunFile& file);
  void read_dense_links(const RunFile& file);
  [[nodiscard]] const Column* stored_column(const RunFile& file, const Column& column) const;
  [[nodiscard]] std::string difference_in_table(std::size_t frame, const Simulation& simulation);
  [[nodiscard]] std::string difference_in_dense_links(std::size_t frame, const Simulation& simulation) const;
  [[nodiscard]] std::string pair_name(const BodyPair& pair) const;

  Schema simulated_;
  bool is_format_1_;
  std::vector<Stored> rows_, table_;
  std::vector<DenseColumn> dense_;
  std::vector<std::pair<std::string, std::string>> pairs_;
  std::size_t table_row_ = 0;  ///< the table's first row of the next frame
};

}  // namespace verisim::cli
