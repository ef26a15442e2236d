#pragma once

#include <chrono>
#include <cstdint>
#include <stdexcept>
#include <string>

#include "platform/config/board_yaml.h"

struct sqlite3;
struct sqlite3_stmt;

namespace stereotlm::explore {

// What SQLite could not do: what() names the file and says why.
class DatabaseError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// An open SQLite database. Its member functions, and those of its statements, throw DatabaseError. Not to be
// used across fork().
class Database {
 public:
  enum class Access { kRead, kWrite, kCreate, kMemory };

  // For how long it waits for a process that keeps the file locked.
  static constexpr std::chrono::milliseconds kBusyTimeout = std::chrono::minutes(1);

  // kMemory opens a new database in memory, for which `path` is the name in messages. Otherwise `path` is
  // that of a file, also if it is ":memory:" or begins with "file:".
  Database(const std::string& path, Access access, std::chrono::milliseconds busy_timeout = kBusyTimeout);
  ~Database();
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  void execute(const std::string& sql);
  // Opens another file as well, whose tables are then NAME.TABLE.
  void attach(const std::string& path, const std::string& name);
  std::int64_t number(const std::string& sql);  // the first column of the first row; 0 if there is none
  const std::string& path() const { return path_; }
  sqlite3* handle() const { return handle_; }
  [[noreturn]] void fail(int code) const;

 private:
  std::string path_;
  sqlite3* handle_ = nullptr;
};

// A prepared statement; its database outlives it.
class Statement {
 public:
  Statement(const Database& database, const std::string& sql);
  ~Statement();
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  // Parameters count from 1.
  void bind(int place, const std::string& text);
  void bind(int place, std::int64_t number);
  void bind(int place, const platform::BoardValue& value);
  // Copies column `column` of the row that `from` stands at.
  void bind_column(int place, const Statement& from, int column);
  void clear_bindings();

  bool step();   // whether there is a row
  void run();    // to its end, and back to its beginning
  void reset();  // back to its beginning

  int columns() const;
  std::string name(int column) const;
  std::string text(int column) const;  // of the row; empty for NULL
  std::int64_t integer(int column) const;
  double real(int column) const;
  bool is_true(int column) const;
  sqlite3_stmt* handle() const { return handle_; }

 private:
  const Database& database_;
  sqlite3_stmt* handle_ = nullptr;
};

// As an identifier of SQL.
std::string quoted_name(const std::string& name);

}  // namespace stereotlm::explore
