#include "engine/batch/database.hpp"

#include <fmt/format.h>
#include <sqlite3.h>

#include "engine/base/error.hpp"
#include "engine/base/user_file.hpp"

namespace verisim::batch {

void refuse_damaged(const std::string& path, const std::string& cause) {
  fail(ErrorKind::input, "{}: is no index of a batch or is damaged ({}); move it away and run the batch again", path,
       cause);
}

namespace {

[[noreturn]] void refuse(sqlite3* database, const std::string& path) {
  const int code = database == nullptr ? SQLITE_NOMEM : sqlite3_extended_errcode(database);
  const std::string cause = database == nullptr ? "out of memory" : sqlite3_errmsg(database);
  switch (code & 0xff) {
    case SQLITE_NOTADB:
    case SQLITE_CORRUPT:
    case SQLITE_ERROR:  // no such table, no such column
    case SQLITE_CONSTRAINT:
    case SQLITE_MISMATCH:
      refuse_damaged(path, cause);
    default:
      fail(ErrorKind::io,
           "{}: cannot be written ({}); make room or name another folder with -o; the same command then goes on", path,
           cause);
  }
}

void check(sqlite3* database, const std::string& path, int code) {
  if (code != SQLITE_OK) refuse(database, path);
}

}  // namespace

std::string sql_name(const std::string& name) {
  std::string text = "\"";
  for (const char c : name) {
    if (c == '"') text += '"';
    text += c;
  }
  return text + "\"";
}

Statement::Statement(sqlite3* database, const std::string& path, const std::string& sql)
    : database_(database), path_(path) {
  check(database, path, sqlite3_prepare_v2(database, sql.c_str(), -1, &statement_, nullptr));
}

Statement::~Statement() {
  sqlite3_finalize(statement_);
}

void Statement::bind(int parameter, const Cell& cell) {
  int code = SQLITE_OK;
  if (const auto* number = std::get_if<double>(&cell))
    code = sqlite3_bind_double(statement_, parameter, *number);
  else if (const auto* whole = std::get_if<std::int64_t>(&cell))
    code = sqlite3_bind_int64(statement_, parameter, *whole);
  else if (const auto* text = std::get_if<std::string>(&cell))
    code = sqlite3_bind_text(statement_, parameter, text->c_str(), static_cast<int>(text->size()), SQLITE_TRANSIENT);
  else
    code = sqlite3_bind_null(statement_, parameter);
  check(database_, path_, code);
}

bool Statement::step() {
  const int code = sqlite3_step(statement_);
  if (code == SQLITE_ROW) return true;
  if (code != SQLITE_DONE) refuse(database_, path_);
  check(database_, path_, sqlite3_reset(statement_));
  return false;
}

Cell Statement::column(int index) const {
  switch (sqlite3_column_type(statement_, index)) {
    case SQLITE_INTEGER:
      return static_cast<std::int64_t>(sqlite3_column_int64(statement_, index));
    case SQLITE_FLOAT:
      return sqlite3_column_double(statement_, index);
    case SQLITE_NULL:
      return {};
    default:
      break;
  }
  const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(statement_, index));
  return std::string(text, static_cast<std::size_t>(sqlite3_column_bytes(statement_, index)));
}

std::string uri_to_read(const std::string& path) {
  std::string uri = "file:";
  for (const char c : path) {
    if (c == '%' || c == '?' || c == '#')
      uri += fmt::format("%{:02X}", static_cast<unsigned char>(c));
    else
      uri += c;
  }
  uri += "?mode=ro";
  // With a log beside it somebody may be writing; without one SQLite need not make one to read.
  if (!identity_of(path + "-wal")) uri += "&immutable=1";
  return uri;
}

Database::Database(const std::string& path, Access access) : path_(path) {
  const bool writes = access == Access::write;
  const int flags = SQLITE_OPEN_URI | (writes ? SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE : SQLITE_OPEN_READONLY);
  const std::string name = writes ? path : uri_to_read(path);
  if (sqlite3_open_v2(name.c_str(), &database_, flags, nullptr) != SQLITE_OK) {
    try {
      refuse(database_, path_);
    } catch (...) {
      sqlite3_close(database_);
      throw;
    }
  }
  constexpr int kWaitMs = 10'000;  // for somebody who reads the index meanwhile
  sqlite3_busy_timeout(database_, kWaitMs);
  if (!writes) return;
  try {
    run("PRAGMA journal_mode=WAL");
    run("PRAGMA synchronous=NORMAL");  // a kill loses nothing; a power cut at most the last rows
  } catch (...) {
    sqlite3_close(database_);
    throw;
  }
}

Database::~Database() {
  sqlite3_close(database_);
}

void Database::run(const std::string& sql) {
  check(database_, path_, sqlite3_exec(database_, sql.c_str(), nullptr, nullptr, nullptr));
}

Cell Database::value(const std::string& sql) {
  Statement statement = prepare(sql);
  return statement.step() ? statement.column(0) : Cell();
}

std::vector<std::string> Database::columns(const std::string& table) {
  Statement statement = prepare("SELECT name FROM pragma_table_info(" + sql_name(table) + ")");
  std::vector<std::string> names;
  while (statement.step()) names.push_back(plain_text(statement.column(0)));
  return names;
}

void Database::settle() {
  sqlite3_busy_timeout(database_, 0);
  sqlite3_exec(database_, "PRAGMA journal_mode=DELETE", nullptr, nullptr, nullptr);
}

void Database::transaction(const std::function<void()>& work) {
  run("BEGIN IMMEDIATE");
  try {
    work();
    run("COMMIT");
  } catch (...) {
    sqlite3_exec(database_, "ROLLBACK", nullptr, nullptr, nullptr);
    throw;
  }
}

}  // namespace verisim::batch
