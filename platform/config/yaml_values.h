#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "platform/config/yaml_tree.h"

namespace stereotlm::platform {

// Decimal digits with an optional minus, not in quotes; nullopt for anything else. A number beyond 64 bits is
// the largest or smallest of them, which no key allows.
std::optional<std::int64_t> integer_of(const YamlNode& node);

// An integer as above, or one with a decimal point and digits on both sides of it. A number beyond the range
// of double is infinite.
std::optional<double> decimal_of(const YamlNode& node);

// The shortest text that decimal_of() reads back as that number, which is finite.
std::string decimal_text(double value);

// A scalar in quotes, or one that no reader of YAML could take for a number, a truth value or null.
bool is_text(const YamlNode& node);

// The text as a flow scalar that every reader of YAML reads back as that text, in quotes where it needs them.
std::string scalar_text(const std::string& text);

}  // namespace stereotlm::platform
