#include "sw/sqlite/database.h"

#include <fmt/format.h>
#include <sqlite3.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>

namespace stereotlm::sqlite {
namespace {

// [Database::Access]
constexpr std::array kFlags = {SQLITE_OPEN_READONLY, SQLITE_OPEN_READWRITE,
                               SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE,
                               SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE};

// Makes the path absolute, so that SQLite takes it for a file. It would take ":memory:" for a database in
// memory, and "file:.." for a URI.
std::string absolute(const std::string& path) {
  const std::filesystem::path file(path);
  return file.is_absolute() ? path : (std::filesystem::current_path() / file).string();
}

}  // namespace

Database::Database(const std::string& path, Access access, std::chrono::milliseconds busy_timeout,
                   const std::string& name)
    : path_(name.empty() ? path : name) {
  const std::string file = access == Access::kMemory ? ":memory:" : absolute(path);
  std::error_code none;
  const std::filesystem::file_status status = std::filesystem::status(file, none);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
    throw DatabaseError(path_ + ": must be a regular file");  // SQLite would wait for a pipe
  // One thread uses the connection, so that SQLite needs no mutex.
  const int flags = kFlags[static_cast<std::size_t>(access)] | SQLITE_OPEN_NOMUTEX;
  const int code = sqlite3_open_v2(file.c_str(), &handle_, flags, nullptr);
  if (code != SQLITE_OK) {
    const DatabaseError error = error_of(code);
    sqlite3_close(handle_);
    throw error;
  }
  sqlite3_extended_result_codes(handle_, 1);
  sqlite3_busy_timeout(handle_, static_cast<int>(busy_timeout.count()));
  // A word in double quotes is a name or an error, never a string.
  sqlite3_db_config(handle_, SQLITE_DBCONFIG_DQS_DML, 0, nullptr);
  sqlite3_db_config(handle_, SQLITE_DBCONFIG_DQS_DDL, 0, nullptr);
}

Database::~Database() { sqlite3_close(handle_); }

// `errno` counts if input or output failed, or a file could not be opened.
DatabaseError Database::error_of(int code) const {
  const int kind = code & 0xFF;
  const int error = sqlite3_system_errno(handle_);
  const bool is_of_system = kind == SQLITE_IOERR || kind == SQLITE_CANTOPEN;
  const bool is_full = kind == SQLITE_FULL || (is_of_system && (error == ENOSPC || error == EDQUOT));
  std::string text = sqlite3_errmsg(handle_);
  if (code == SQLITE_READONLY_ROLLBACK) {
    text = fmt::format(
        "{0}-journal was left by an unfinished change, and this command only reads: "
        "`stereotlm merge {0} {0}` rolls the change back",
        path_);
  } else if (is_full) {
    text = "the disk is full";
  } else if (kind == SQLITE_BUSY || kind == SQLITE_LOCKED) {
    text = "another process keeps it locked";
  } else if (kind == SQLITE_READONLY || kind == SQLITE_PERM) {
    text = "not writable";
  } else if (kind == SQLITE_CANTOPEN) {
    text = error != 0 ? fmt::format("cannot be opened: {}", std::strerror(error)) : "cannot be opened";
  } else if (kind == SQLITE_NOTADB) {
    text = "not a database";
  }
  return DatabaseError(path_ + ": " + text);
}

void Database::fail(int code) const { throw error_of(code); }

void Database::interrupt_if(const std::function<bool()>& is_interrupted) {
  constexpr int kInstructions = 1000;  // of SQLite's virtual machine, between two calls
  is_interrupted_ = is_interrupted;
  sqlite3_progress_handler(
      handle_, kInstructions,
      [](void* database) { return static_cast<Database*>(database)->is_interrupted_() ? 1 : 0; }, this);
}

void Database::execute(const std::string& sql) {
  const int code = sqlite3_exec(handle_, sql.c_str(), nullptr, nullptr, nullptr);
  if (code != SQLITE_OK) fail(code);
}

void Database::attach(const std::string& path, const std::string& name) {
  Statement statement(*this, "ATTACH ? AS " + quoted_name(name));
  statement.bind(1, absolute(path));
  statement.run();
}

std::int64_t Database::number(const std::string& sql) {
  Statement statement(*this, sql);
  return statement.step() ? statement.integer(0) : 0;
}

std::vector<std::string> Database::texts(const std::string& sql) const {
  std::vector<std::string> texts;
  Statement statement(*this, sql);
  while (statement.step()) texts.push_back(statement.text(0));
  return texts;
}

Statement::Statement(const Database& database, const std::string& sql) : database_(database) {
  const char* rest = nullptr;
  const int code = sqlite3_prepare_v2(database.handle(), sql.c_str(), -1, &handle_, &rest);
  if (code != SQLITE_OK) database.fail(code);
  if (*rest != '\0') {
    sqlite3_finalize(handle_);
    throw DatabaseError(database.path() + ": more than one statement");
  }
}

Statement::~Statement() { sqlite3_finalize(handle_); }

void Statement::bind(int place, const std::variant<std::int64_t, double, std::string>& value) {
  int code = SQLITE_OK;
  if (const auto* integer = std::get_if<std::int64_t>(&value)) {
    code = sqlite3_bind_int64(handle_, place, *integer);
  } else if (const auto* number = std::get_if<double>(&value)) {
    code = sqlite3_bind_double(handle_, place, *number);
  } else {
    const auto& text = std::get<std::string>(value);
    code = sqlite3_bind_text(handle_, place, text.data(), static_cast<int>(text.size()), SQLITE_TRANSIENT);
  }
  if (code != SQLITE_OK) database_.fail(code);
}

void Statement::clear_bindings() { sqlite3_clear_bindings(handle_); }

bool Statement::step() {
  const int code = sqlite3_step(handle_);
  if (code == SQLITE_ROW) return true;
  if (code == SQLITE_DONE) return false;
  sqlite3_reset(handle_);
  database_.fail(code);
}

void Statement::run() {
  while (step()) {
  }
  reset();
}

void Statement::reset() { sqlite3_reset(handle_); }

int Statement::columns() const { return sqlite3_column_count(handle_); }

std::string Statement::name(int column) const { return sqlite3_column_name(handle_, column); }

std::string Statement::text(int column) const {
  const auto* const text = reinterpret_cast<const char*>(sqlite3_column_text(handle_, column));
  return text == nullptr ? ""
                         : std::string(text, static_cast<std::size_t>(sqlite3_column_bytes(handle_, column)));
}

double Statement::real(int column) const { return sqlite3_column_double(handle_, column); }

std::int64_t Statement::integer(int column) const { return sqlite3_column_int64(handle_, column); }

bool Statement::is_true(int column) const {
  return sqlite3_column_type(handle_, column) != SQLITE_NULL && sqlite3_column_double(handle_, column) != 0;
}

std::string quoted_name(const std::string& name) {
  std::string text = "\"";
  for (const char c : name) {
    if (c == '"') text += c;
    text += c;
  }
  return text + '"';
}

}  // namespace stereotlm::sqlite
