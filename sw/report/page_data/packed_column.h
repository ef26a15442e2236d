#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <variant>
#include <vector>

namespace stereotlm::report {

// Packs the values of a column, one for each row of a table, into little text: the columns of
// sw/report/page/README.md.
class PackedColumn {
 public:
  using Value = std::variant<std::monostate, std::int64_t, double, std::string>;

  void add(const Value& value);
  // The same for a text, which is quick if it is that of the row before.
  void add_text(std::string_view text);

  std::size_t size() const { return codes_.size(); }
  bool is_constant() const { return values_.size() < 2; }
  // The value of all rows. The column must be constant and not empty.
  const Value& constant() const { return values_.front(); }
  // The column as JSON, without its name.
  nlohmann::ordered_json json() const;

 private:
  std::vector<Value> values_;  // all different, in the order of their first rows
  std::unordered_map<Value, std::uint32_t> known_;
  std::vector<std::uint32_t> codes_;  // for each row an index of values_
};

nlohmann::ordered_json json_of(const PackedColumn::Value& value);

}  // namespace stereotlm::report
