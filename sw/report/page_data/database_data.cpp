#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "sw/explore/store/store.h"
#include "sw/process/streams.h"
#include "sw/report/page_data/page_data.h"
#include "sw/sqlite/database.h"

namespace stereotlm::report {
namespace {

using Json = nlohmann::ordered_json;

// Of the counters of each bank and each port the page has one: the others would make it too large.
bool is_shown(const std::string& column) {
  static const std::regex hidden(
      "hash|config|frame_cycles|banks\\.(?!.*\\.utilization$).*|ports\\.(?!.*\\.stall_cycles$).*");
  return !std::regex_match(column, hidden);
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

// The values of a column.
struct Column {
  Json constant;
  Json list = Json::array();  // empty as long as all values are the same

  void add(std::size_t row, const Json& value) {
    if (row == 0) constant = value;
    if (list.empty() && value != constant) list = std::vector<Json>(row, constant);
    if (!list.empty()) list.push_back(value);
  }
};

// Files of boards, most lines of which are in many of them.
struct BoardTexts {
  std::map<std::string, std::size_t, std::less<>> numbers;  // of the lines
  Json lines = Json::array();
  Json texts = Json::array();  // the numbers of the lines of each

  void add(std::string_view text) {
    std::vector<std::size_t> found;
    while (!text.empty()) {
      const std::string_view line = text.substr(0, std::min(text.find('\n'), text.size() - 1) + 1);
      auto known = numbers.find(line);
      if (known == numbers.end()) {
        known = numbers.emplace(line, lines.size()).first;
        lines.push_back(line);
      }
      found.push_back(known->second);
      text.remove_prefix(line.size());
    }
    texts.push_back(found);
  }
};

}  // namespace

Json database_data(const std::string& path) {
  sqlite::Database database(path, sqlite::Database::Access::kRead);
  const std::vector<std::string> names = explore::store_columns(database);
  std::map<std::size_t, Column> columns;  // those that are shown, by their places in `names`
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (is_shown(names[i])) columns[i] = {};
  }
  const auto config = std::find(names.begin(), names.end(), "config") - names.begin();
  BoardTexts boards;
  sqlite::Statement points(database, "SELECT * FROM points ORDER BY hash");
  std::size_t size = 0;
  for (; !process::interrupted() && points.step(); ++size) {
    for (auto& [i, column] : columns) column.add(size, value_of(points, static_cast<int>(i)));
    boards.add(points.text(static_cast<int>(config)));
  }
  if (size == 0) throw std::runtime_error(fmt::format("'{}': has no points", path));
  Json shown = Json::array();
  for (auto& [i, column] : columns) {
    const bool is_constant = column.list.empty();
    shown.push_back({{"name", names[i]}});
    shown.back()[is_constant ? "constant" : "list"] = std::move(is_constant ? column.constant : column.list);
  }
  return {{"path", path},
          {"points", size},
          {"keys", database.texts("SELECT name FROM keys ORDER BY name")},
          {"columns", std::move(shown)},
          {"boards", {{"lines", std::move(boards.lines)}, {"points", std::move(boards.texts)}}}};
}

}  // namespace stereotlm::report
