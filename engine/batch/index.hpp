// The index of a batch: index.sqlite, a row per run, and the CSVs that are made of it (INTERFACES section 5).
//
// Tables: `run` (what every machine computes alike), `timing` (the wall clock and the machine), `unit` (column, unit,
// meaning), `input` (files that runs read, with their SHA-256), `meta` (format, layout). One process writes it: the
// batch's own, which has a lock on the folder; a run's two rows are one transaction. Whoever wants to may read
// meanwhile.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "engine/base/json.hpp"
#include "engine/batch/answer.hpp"
#include "engine/batch/database.hpp"

namespace verisim::batch {

struct IndexColumn {
  std::string name;
  std::string type;  ///< as SQL has it: REAL, INTEGER, TEXT
  std::string unit, meaning;
};

/// The columns that an index has from its beginning; those of measures come with the runs that measure.
struct Layout {
  std::vector<IndexColumn> parameters, figures, timing;
};

[[nodiscard]] Json to_json(const Layout& layout);
[[nodiscard]] Layout layout_of(const Json& json);

/// What stands in a row of `run` besides the answer.
struct RowHead {
  std::uint64_t run = 0, seed = 0;
  std::vector<Cell> parameters;  ///< in the order of the layout's
};

class Index {
 public:
  /// Opens or makes the index. Error(input): of another format, or made by another version of the program, with the
  /// remedy; or damaged: columns or rows are missing, a row has no status. Error(io).
  Index(const std::string& path, const Layout& layout, const std::string& version);
  /// Opens one that is there already, to be read. Error(input): there is none.
  [[nodiscard]] static Index open(const std::string& path, const std::string& version);

  /// All runs read this content of a file: those of another one are refused.
  void expect_input(const std::string& name, const std::string& sha256);
  /// Names of the files that runs read.
  [[nodiscard]] std::vector<std::string> inputs();
  /// The numbers of the runs that it holds, sorted. Error(input) if one is not below `end`.
  [[nodiscard]] std::vector<std::uint64_t> runs(std::uint64_t end = std::numeric_limits<std::uint64_t>::max());
  /// A run's rows, in one transaction. Error(input): the run read another content of a file than a run before it, or
  /// its measures have names that SQL takes for one. Error(io).
  void add(const RowHead& head, const Answer& answer);
  /// Takes over all rows of another index of the same layout. @pre none of its runs is here
  void take_over(const std::string& path);

  /// Names of the columns of measures, sorted; `run` and measure names that another column has begin with "measure.".
  [[nodiscard]] std::vector<std::string> measure_columns();
  [[nodiscard]] const Layout& layout() const { return layout_; }
  [[nodiscard]] std::string unit_of(const std::string& column);

  /// Rows of `run` in the order of runs, these columns of each.
  void read(const std::vector<std::string>& columns, const std::function<void(const std::vector<Cell>&)>& row);
  /// index.csv and timing.csv, whole or not at all; the index is then ready to be read without a log, and its columns
  /// stand in one order, whichever run brought them. Error(io).
  void write_csv(const std::string& folder);
  /// Number of runs by status, and of those without an answer: all, or of one status.
  [[nodiscard]] std::uint64_t count(const std::string& status);
  [[nodiscard]] std::uint64_t count_unanswered(const std::string& status = {});
  /// Takes the rows of runs without an answer away, so that they are done again.
  void forget_unanswered();
  /// Calls `each` for every set of values that these columns of `timing` have, with the number of its runs, the set of
  /// the first run first.
  void count_timing_by(const std::vector<std::string>& columns,
                       const std::function<void(const std::vector<Cell>&, std::uint64_t)>& each);
  /// Of runs that diverged, and if asked of those that are done: how many have no run file.
  [[nodiscard]] std::uint64_t count_without_run_file(bool of_done);

 private:
  Index(const std::string& path, Database::Access access) : database_(std::make_unique<Database>(path, access)) {}
  void check_version(const std::string& version);
  void check_tables();
  void make_tables(const std::string& version);
  void make_run_table(const std::string& name);
  void put_in_order();
  std::string column_of(const Measure& measure);
  void add_inputs(const Answer& answer);
  std::string table_csv(const std::string& table, const std::vector<std::string>& columns);

  std::unique_ptr<Database> database_;
  Layout layout_;
};

}  // namespace verisim::batch
