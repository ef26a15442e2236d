#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

struct sqlite3;
struct sqlite3_stmt;

namespace stereotlm::sqlite {

// A call of SQLite failed. what() names the file and the reason.
class DatabaseError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// An open SQLite database. The member functions of Database and Statement throw DatabaseError. Must not be
// used across fork().
class Database {
 public:
  enum class Access { kRead, kWrite, kCreate, kMemory };

  // The default time that a call waits for a process that has locked the file.
  static constexpr std::chrono::milliseconds kBusyTimeout = std::chrono::minutes(1);

  // With kMemory the database is a new one in memory, and `path` is its name in messages. Otherwise `path` is
  // the path of a regular file, even if it is ":memory:" or begins with "file:". `name`: the file in
  // messages, if that is not its path.
  Database(const std::string& path, Access access, std::chrono::milliseconds busy_timeout = kBusyTimeout,
           const std::string& name = "");
  ~Database();
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  // From now on every call fails as soon as this function returns true.
  void interrupt_if(const std::function<bool()>& is_interrupted);
  void execute(const std::string& sql);
  // Opens another file as well; the names of its tables are NAME.TABLE.
  void attach(const std::string& path, const std::string& name);
  // The first column of the first row of a query; 0 if there is no row.
  std::int64_t number(const std::string& sql);
  // The first column of each row of a query.
  std::vector<std::string> texts(const std::string& sql) const;
  const std::string& path() const { return path_; }  // its name in messages
  sqlite3* handle() const { return handle_; }
  // Throws the DatabaseError for a result code of SQLite.
  [[noreturn]] void fail(int code) const;

 private:
  DatabaseError error_of(int code) const;

  std::string path_;
  sqlite3* handle_ = nullptr;
  std::function<bool()> is_interrupted_;
};

// A prepared statement. The database must outlive it.
class Statement {
 public:
  Statement(const Database& database, const std::string& sql);
  ~Statement();
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  // Sets parameter number `place`, counted from 1, to a value.
  void bind(int place, const std::variant<std::int64_t, double, std::string>& value);
  void clear_bindings();

  bool step();   // goes to the next row; returns whether there is one
  void run();    // goes through all rows, then resets
  void reset();  // goes back to the position before the first row

  int columns() const;
  std::string name(int column) const;
  // Columns of the current row. NULL reads as "", 0 and false.
  std::string text(int column) const;
  std::int64_t integer(int column) const;
  double real(int column) const;
  bool is_true(int column) const;
  sqlite3_stmt* handle() const { return handle_; }

 private:
  const Database& database_;
  sqlite3_stmt* handle_ = nullptr;
};

// The name as an identifier of SQL, in quotes.
std::string quoted_name(const std::string& name);

}  // namespace stereotlm::sqlite
