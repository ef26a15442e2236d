#pragma once

#include <optional>
#include <string>
#include <vector>

#include "platform/config/board_config.h"

namespace stereotlm::explore {

// Functions for the names of banks in names of columns. SQLite ignores the case of letters there, but names
// of banks are case-sensitive.

// The name with letters A to Z in lower case.
std::string without_case(std::string name);

// Whether two different names become equal without_case().
bool differ_in_case(const std::string& a, const std::string& b);

// The rule that the bank names of a board break, as `key = value: rule`, if a database cannot have a column
// for each bank; nothing if it can.
std::optional<std::string> bank_names_problem(const platform::BoardConfig& board);

// The same rule for two names that differ_in_case().
std::string bank_names_problem(const std::string& one, const std::string& other);

}  // namespace stereotlm::explore
