#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "platform/config/yaml_tree.h"

namespace stereotlm::platform {

// Reads decimal digits with an optional minus, not in quotes; returns nullopt for anything else. A number
// beyond 64 bits becomes the largest or smallest 64-bit number, which no key allows.
std::optional<std::int64_t> integer_of(const YamlNode& node);

// Reads an integer as integer_of() does, or a number with digits on both sides of a decimal point; returns
// nullopt for anything else. A number beyond the range of double becomes infinite.
std::optional<double> decimal_of(const YamlNode& node);

// The shortest text that decimal_of() reads back as `value`, which must be finite.
std::string decimal_text(double value);

// Whether the value is a scalar in quotes, or one that no reader of YAML takes for a number, a boolean or
// null.
bool is_text(const YamlNode& node);

// `text` as a flow scalar, which every reader of YAML reads back as the same text. It is in quotes where
// needed.
std::string scalar_text(const std::string& text);

}  // namespace stereotlm::platform
