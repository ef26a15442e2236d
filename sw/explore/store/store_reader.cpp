#include "sw/explore/store/store_reader.h"

#include "sw/explore/store/store_layout.h"

namespace stereotlm::explore {

FinishedStore::FinishedStore(const std::string& path, const std::string& version)
    : database_(path, sqlite::Database::Access::kRead) {
  check_layout(database_);
  check_version(database_, version);
  find_.emplace(database_, kFindPoint);
}

bool FinishedStore::has(const std::string& hash) { return has_point(*find_, hash); }

StoredRow::StoredRow(const std::string& path)
    : database_(path, sqlite::Database::Access::kRead),
      find_(database_, "SELECT * FROM points WHERE hash = ?") {
  for (int column = 0; column < find_.columns(); ++column) columns_[find_.name(column)] = column;
}

bool StoredRow::find(const std::string& hash) {
  find_.reset();
  find_.bind(1, hash);
  return find_.step();
}

std::string StoredRow::text(const std::string& column) const {
  const auto found = columns_.find(column);
  return found == columns_.end() ? "" : find_.text(found->second);
}

std::int64_t StoredRow::integer(const std::string& column) const {
  const auto found = columns_.find(column);
  return found == columns_.end() ? 0 : find_.integer(found->second);
}

double StoredRow::real(const std::string& column) const {
  const auto found = columns_.find(column);
  return found == columns_.end() ? 0 : find_.real(found->second);
}

}  // namespace stereotlm::explore
