#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace stereotlm::report {

inline constexpr double kLetterHeight = 1.18;  // of a line of text, in font sizes

// The width of a UTF-8 text of this size. It is that of DejaVu Sans, which is wider than the other fonts of
// the chart, so that no viewer needs more.
double text_width(std::string_view text, double size, bool bold);

// The text if it fits, else its beginning and its end around an ellipsis. Names often differ in their ends.
std::string fitted(const std::string& text, double size, bool bold, double width);

// The UTF-8 text without control characters, as all names of a board are, for XML: in an element or an
// attribute. U+FFFE and U+FFFF, which XML cannot have, become U+FFFD.
std::string xml_text(std::string_view text);

// A figure of the configuration. At most two decimals, without trailing zeros: "160", "133.33", "5.7";
// "<0.01" for less.
std::string short_number(double value);

// A measured figure. One decimal: "144.4", "5.0"; "<0.1" for less, and "0" for nothing.
std::string measured(double value);

// A rate in frames/s: two decimals below 100, else one.
std::string rate_text(double frames_per_second);

// A count, with commas from 10,000 on.
std::string grouped(std::uint64_t count);

}  // namespace stereotlm::report
