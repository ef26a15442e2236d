#include "sw/report/page_data/packed_column.h"

#include <algorithm>
#include <string_view>

#include "sw/files/base64.h"

namespace stereotlm::report {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

std::size_t letters_for(std::size_t values) {
  std::size_t letters = 1;
  for (std::size_t reach = kLetters.size(); reach < values; reach *= kLetters.size()) ++letters;
  return letters;
}

// Each code in `letters` digits to the base 64, the most significant first.
std::string letters_of(const std::vector<std::uint32_t>& codes, std::size_t letters) {
  std::string text(letters * codes.size(), '\0');
  std::size_t end = 0;
  for (const std::uint32_t code : codes) {
    end += letters;
    std::size_t rest = code;
    for (std::size_t place = end; place-- > end - letters; rest /= kLetters.size())
      text[place] = kLetters[rest % kLetters.size()];
  }
  return text;
}

}  // namespace

Json json_of(const PackedColumn::Value& value) {
  if (const auto* integer = std::get_if<std::int64_t>(&value)) return *integer;
  if (const auto* real = std::get_if<double>(&value)) return *real;
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  return nullptr;
}

void PackedColumn::add(const Value& value) {
  if (!codes_.empty() && values_[codes_.back()] == value) return codes_.push_back(codes_.back());
  const auto [place, is_new] = known_.try_emplace(value, static_cast<std::uint32_t>(values_.size()));
  if (is_new) values_.push_back(value);
  codes_.push_back(place->second);
}

void PackedColumn::add_text(std::string_view text) {
  const auto* const before = codes_.empty() ? nullptr : std::get_if<std::string>(&values_[codes_.back()]);
  if (before != nullptr && *before == text) {
    codes_.push_back(codes_.back());
  } else {
    add(std::string(text));
  }
}

Json PackedColumn::json() const {
  if (is_constant()) return {{"constant", values_.empty() ? Json() : json_of(constant())}};
  Json values = Json::array();
  for (const Value& value : values_) values.push_back(json_of(value));
  Json packed = {{"values", std::move(values)}, {"codes", letters_of(codes_, letters_for(values_.size()))}};
  const bool is_real = std::all_of(values_.begin(), values_.end(),
                                   [](const Value& value) { return std::holds_alternative<double>(value); });
  if (!is_real) return packed;
  std::vector<double> reals;
  reals.reserve(codes_.size());
  for (const std::uint32_t code : codes_) reals.push_back(std::get<double>(values_[code]));
  std::string bytes = files::base64(reals.data(), reals.size() * sizeof(double));
  if (bytes.size() < packed.dump().size()) return {{"float64", std::move(bytes)}};
  return packed;
}

}  // namespace stereotlm::report
