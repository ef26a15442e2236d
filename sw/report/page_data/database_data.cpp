#include "sw/report/page_data/database_data.h"

#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "sw/explore/store/store_layout.h"
#include "sw/process/interrupt.h"
#include "sw/sqlite/database.h"

namespace stereotlm::report {
namespace {

using Json = nlohmann::ordered_json;

bool begins(std::string_view text, std::string_view head) { return text.substr(0, head.size()) == head; }
bool ends(std::string_view text, std::string_view tail) {
  return text.size() >= tail.size() && text.substr(text.size() - tail.size()) == tail;
}

// Of the counters of each bank and each port the page has one: the others would make it too large.
bool is_shown(const std::string& column) {
  static const std::set<std::string> never = {"hash", "config", "frame_cycles"};
  if (never.count(column) > 0) return false;
  if (begins(column, "banks.")) return ends(column, ".busy_cycles");
  if (begins(column, "ports.")) return ends(column, ".stall_cycles");
  return true;
}

Json value_of(const sqlite::Statement& row, int column) {
  switch (sqlite3_column_type(row.handle(), column)) {
    case SQLITE_NULL:
      return nullptr;
    case SQLITE_INTEGER:
      return row.integer(column);
    case SQLITE_FLOAT:
      return row.real(column);
    default:
      return row.text(column);
  }
}

// The values of a column. As long as all are the same, only one is kept.
template <typename Value>
class Column {
 public:
  template <typename Text>
  void add(const Text& value) {
    if (size_ == 0) first_ = value;
    if (all_.empty() && !(first_ == value)) all_.assign(size_, first_);
    if (!all_.empty()) all_.emplace_back(value);
    ++size_;
  }
  bool is_constant() const { return all_.empty(); }
  const Value& first() const { return first_; }
  Json json() const { return is_constant() ? Json{{"constant", first_}} : Json{{"list", all_}}; }

 private:
  std::size_t size_ = 0;
  Value first_;
  std::vector<Value> all_;
};

// Texts of which most words are the same: files of boards. Texts with as many words have one shape.
class BoardTexts {
 public:
  void add(std::string_view text) {
    const std::vector<std::string_view> words = words_of(text);
    const auto [shape, is_new] = shapes_.emplace(
        words.size(), std::pair(shapes_.size(), std::vector<Column<std::string>>(words.size())));
    shape_of_row_.add(shape->second.first);
    for (std::size_t i = 0; i < words.size(); ++i) shape->second.second[i].add(words[i]);
  }

  Json json() const {
    std::vector<Json> shapes(shapes_.size());
    for (const auto& [length, shape] : shapes_) {
      Json words = Json::array();
      for (const Column<std::string>& word : shape.second)
        words.push_back(word.is_constant() ? Json(word.first()) : word.json());
      shapes[shape.first] = std::move(words);
    }
    return {{"shape", shape_of_row_.json()}, {"shapes", std::move(shapes)}};
  }

 private:
  // The text in pieces, each of which ends with a space or a newline.
  static std::vector<std::string_view> words_of(std::string_view text) {
    std::vector<std::string_view> words;
    for (std::size_t end = text.find_first_of(" \n"); end != text.npos; end = text.find_first_of(" \n")) {
      words.push_back(text.substr(0, end + 1));
      text.remove_prefix(end + 1);
    }
    words.push_back(text);
    return words;
  }

  // By the number of words: the number of the shape, and its words.
  std::map<std::size_t, std::pair<std::size_t, std::vector<Column<std::string>>>> shapes_;
  Column<std::size_t> shape_of_row_;
};

}  // namespace

Json database_data(const std::string& path) {
  sqlite::Database database(path, sqlite::Database::Access::kRead);
  explore::check_layout(database);
  const std::vector<std::string> names = explore::columns_of(database);
  std::vector<Column<Json>> columns(names.size());
  std::vector<bool> shown_columns;
  for (const std::string& name : names) shown_columns.push_back(is_shown(name));
  BoardTexts boards;
  sqlite::Statement points(database, "SELECT * FROM points ORDER BY hash");
  std::size_t size = 0;
  for (; !process::interrupted() && points.step(); ++size) {
    for (std::size_t i = 0; i < names.size(); ++i) {
      const int column = static_cast<int>(i);
      if (shown_columns[i]) columns[i].add(value_of(points, column));
      if (names[i] == "config") boards.add(points.text(column));
    }
  }
  if (size == 0) throw std::runtime_error(fmt::format("'{}': has no points", path));
  Json shown = Json::array();
  Json left_out = Json::array();
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (!shown_columns[i]) {
      left_out.push_back(names[i]);
      continue;
    }
    Json column = {{"name", names[i]}};
    column.update(columns[i].json());
    shown.push_back(std::move(column));
  }
  return {{"path", path},
          {"points", size},
          {"keys", explore::first_column_of(database, "SELECT name FROM keys ORDER BY name")},
          {"columns", std::move(shown)},
          {"left_out", std::move(left_out)},
          {"boards", boards.json()}};
}

}  // namespace stereotlm::report
