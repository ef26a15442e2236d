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
      "hash|config|frame_cycles|banks\\.(?!.*\\.busy_cycles$).*|ports\\.(?!.*\\.stall_cycles$).*");
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
  std::vector<Column> columns(names.size());
  std::vector<bool> shown_columns;
  for (const std::string& name : names) shown_columns.push_back(is_shown(name));
  BoardTexts boards;
  sqlite::Statement points(database, "SELECT * FROM points ORDER BY hash");
  std::size_t size = 0;
  for (; !process::interrupted() && points.step(); ++size) {
    for (std::size_t i = 0; i < names.size(); ++i) {
      const int column = static_cast<int>(i);
      if (shown_columns[i]) columns[i].add(size, value_of(points, column));
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
    shown.push_back({{"name", names[i]}});
    if (columns[i].list.empty()) {
      shown.back()["constant"] = std::move(columns[i].constant);
    } else {
      shown.back()["list"] = std::move(columns[i].list);
    }
  }
  return {{"path", path},
          {"points", size},
          {"keys", database.texts("SELECT name FROM columns WHERE is_key ORDER BY name")},
          {"columns", std::move(shown)},
          {"left_out", std::move(left_out)},
          {"boards", {{"lines", std::move(boards.lines)}, {"points", std::move(boards.texts)}}}};
}

}  // namespace stereotlm::report
