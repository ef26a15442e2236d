#pragma once

#include <optional>
#include <string>
#include <vector>

#include "platform/config/board_config.h"

namespace stereotlm::explore {

// Names of columns of a database ignore the case of letters, names of banks do not.

// The same for names that differ in nothing but the case of letters.
std::string without_case(std::string name);

// Whether they differ, but in nothing else.
bool differ_in_case(const std::string& a, const std::string& b);

// Why a database cannot have columns for all banks of a board: `key = value: rule`. Nothing: it can.
std::optional<std::string> bank_names_problem(const platform::BoardConfig& board);

// The same of two names that differ_in_case().
std::string bank_names_problem(const std::string& one, const std::string& other);

}  // namespace stereotlm::explore
