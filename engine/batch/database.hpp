// SQLite, as far as a batch needs it: an open file, statements, rows. Errors of the disk are Error(io) with the place,
// what is no database or not the one that was made here Error(input).
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "engine/batch/cell.hpp"

struct sqlite3;
struct sqlite3_stmt;

namespace verisim::batch {

/// Error(input): the index is to be moved away and made again.
[[noreturn]] void refuse_damaged(const std::string& path, const std::string& cause);

/// "NAME" as an identifier of SQL.
[[nodiscard]] std::string sql_name(const std::string& name);

/// One statement, prepared once.
class Statement {
 public:
  Statement(sqlite3* database, const std::string& path, const std::string& sql);
  ~Statement();
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  /// Of a parameter `?`, from 1.
  void bind(int parameter, const Cell& cell);
  /// True if there is a row; false at the end, which begins anew.
  bool step();
  [[nodiscard]] Cell column(int index) const;  ///< from 0

 private:
  sqlite3* database_;
  std::string path_;
  sqlite3_stmt* statement_ = nullptr;
};

/// What names a database to be read, to sqlite3_open_v2 and ATTACH.
[[nodiscard]] std::string uri_to_read(const std::string& path);

class Database {
 public:
  enum class Access { write, read };
  /// Opens the file. To write: makes it if it is not there; WAL, so that what one transaction wrote outlives a kill -9.
  /// To read: neither it nor its folder has to be writable. Error(io): it cannot be opened; Error(input): it is
  /// damaged.
  explicit Database(const std::string& path, Access access = Access::write);
  ~Database();
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  void run(const std::string& sql);
  /// The first cell of the first row; nothing if there is none.
  [[nodiscard]] Cell value(const std::string& sql);
  [[nodiscard]] Statement prepare(const std::string& sql) { return Statement(database_, path_, sql); }
  [[nodiscard]] std::vector<std::string> columns(const std::string& table);
  /// All that `work` does is there, or nothing of it.
  void transaction(const std::function<void()>& work);
  /// Nothing more will be written for now: readers need not write, either, not even a log beside it. While somebody
  /// reads it stays as it is.
  void settle();
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
  sqlite3* database_ = nullptr;
};

}  // namespace verisim::batch
