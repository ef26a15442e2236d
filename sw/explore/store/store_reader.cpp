#include "sw/explore/store/store_reader.h"

#include <fmt/format.h>

#include <algorithm>

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

StoreReader::StoreReader(const std::string& path) : database_(path, sqlite::Database::Access::kRead) {
  check_layout(database_);
  columns_ = columns_of(database_);
  keys_ = first_column_of(database_, "SELECT name FROM keys");
  points_.emplace(database_, "SELECT * FROM points ORDER BY hash");
  blame_of_point_.emplace(
      database_,
      fmt::format("SELECT {} FROM blame WHERE hash = ? ORDER BY hash, port, bank, by", kBlameColumns));
  blame_.emplace(database_, fmt::format("SELECT {} FROM blame ORDER BY hash, port, bank, by", kBlameColumns));
  next();
}

std::vector<std::string> StoreReader::versions() const {
  return first_column_of(database_, "SELECT DISTINCT version FROM points ORDER BY version");
}

void StoreReader::next() {
  has_point_ = points_->step();
  hash_ = has_point_ ? points_->text(0) : "";
}

std::string StoreReader::whole_text(const std::vector<std::string>& columns) {
  std::string text;
  for (const std::string& column : columns) {
    const auto found = std::find(columns_.begin(), columns_.end(), column);
    if (found != columns_.end()) text += points_->text(static_cast<int>(found - columns_.begin()));
    text += '\n';
  }
  blame_of_point_->bind(1, hash_);
  while (blame_of_point_->step()) {
    for (int column = 1; column < blame_of_point_->columns(); ++column)
      text += blame_of_point_->text(column) + ' ';
  }
  blame_of_point_->reset();
  return text;
}

}  // namespace stereotlm::explore
