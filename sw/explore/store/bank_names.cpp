#include "sw/explore/store/bank_names.h"

#include <fmt/format.h>

namespace stereotlm::explore {

std::string without_case(std::string name) {
  for (char& c : name) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return name;
}

bool differ_in_case(const std::string& a, const std::string& b) {
  return a != b && without_case(a) == without_case(b);
}

std::optional<std::string> bank_names_problem(const platform::BoardConfig& board) {
  for (const platform::BankConfig& one : board.banks) {
    for (const platform::BankConfig& other : board.banks) {
      if (differ_in_case(one.name, other.name)) return bank_names_problem(one.name, other.name);
    }
  }
  return std::nullopt;
}

std::string bank_names_problem(const std::string& one, const std::string& other) {
  return fmt::format(
      "ssram.banks = {}, {}: the names differ only in case: a database could not distinguish their columns",
      one, other);
}

}  // namespace stereotlm::explore
