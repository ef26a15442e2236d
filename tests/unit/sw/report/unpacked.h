#pragma once

#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace stereotlm::report {

// The values of a packed column, read as sw/report/page/README.md describes it.
inline std::vector<nlohmann::ordered_json> unpacked(const nlohmann::ordered_json& column, std::size_t rows) {
  using Json = nlohmann::ordered_json;
  if (column.contains("constant")) return std::vector<Json>(rows, column["constant"]);
  const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  // Each number of `digits` letters.
  const auto numbers = [&letters](const std::string& text, std::size_t digits) {
    std::vector<std::size_t> all(text.size() / digits);
    for (std::size_t i = 0; i < all.size() * digits; ++i)
      all[i / digits] = 64 * all[i / digits] + letters.find(text[i]);
    return all;
  };
  std::vector<Json> values;
  if (column.contains("float64")) {
    std::string text = column["float64"];
    for (char& letter : text) letter = letter == '=' ? 'A' : letter;
    std::string bytes;
    for (const std::size_t bits : numbers(text, 4)) {
      for (const int shift : {16, 8, 0}) bytes += static_cast<char>(bits >> shift & 0xff);
    }
    for (std::size_t row = 0; row < rows; ++row) {
      double value = 0;
      std::memcpy(&value, bytes.data() + row * sizeof value, sizeof value);
      values.emplace_back(value);
    }
    return values;
  }
  const std::string codes = column["codes"];
  for (const std::size_t code : numbers(codes, codes.size() / rows)) values.push_back(column["values"][code]);
  return values;
}

}  // namespace stereotlm::report
