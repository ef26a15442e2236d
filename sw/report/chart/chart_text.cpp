#include "sw/report/chart/chart_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace stereotlm::report {
namespace {

constexpr std::string_view kEllipsis = "\u2026";

// Advance widths of the characters from space to '~', in thousandths of the font size.
using Widths = std::array<std::uint16_t, 95>;
constexpr Widths kRegular = {318,  401, 460, 838, 636, 950, 780, 275, 390, 390, 500, 838, 318, 361, 318, 337,
                             636,  636, 636, 636, 636, 636, 636, 636, 636, 636, 337, 337, 838, 838, 838, 531,
                             1000, 684, 686, 698, 770, 632, 575, 775, 752, 295, 295, 656, 557, 863, 748, 787,
                             603,  787, 695, 635, 611, 732, 684, 989, 685, 611, 685, 390, 337, 390, 838, 500,
                             500,  613, 635, 550, 635, 615, 352, 635, 634, 278, 278, 579, 278, 974, 634, 612,
                             635,  635, 411, 521, 392, 634, 592, 818, 592, 592, 525, 636, 337, 636, 838};
constexpr Widths kBold = {348,  456, 521, 838, 696, 1002, 872, 306,  457, 457, 523, 838, 380, 415,  380, 365,
                          696,  696, 696, 696, 696, 696,  696, 696,  696, 696, 400, 400, 838, 838,  838, 580,
                          1000, 774, 762, 734, 830, 683,  683, 821,  837, 372, 372, 775, 637, 995,  837, 850,
                          733,  850, 770, 720, 682, 812,  774, 1103, 771, 724, 725, 457, 365, 457,  838, 500,
                          500,  675, 716, 593, 716, 678,  435, 716,  712, 343, 343, 665, 343, 1042, 712, 687,
                          716,  716, 493, 595, 478, 712,  652, 924,  645, 652, 582, 712, 365, 712,  838};
constexpr double kOtherWidth = 1.25;  // of all other characters, in font sizes: that of an emoji

// The characters of a UTF-8 text, each with its bytes.
std::vector<std::string_view> characters(std::string_view text) {
  std::vector<std::string_view> all;
  while (!text.empty()) {
    std::size_t length = 1;
    while (length < text.size() && (static_cast<unsigned char>(text[length]) & 0xC0U) == 0x80) ++length;
    all.push_back(text.substr(0, length));
    text.remove_prefix(length);
  }
  return all;
}

double width_of(std::string_view character, bool bold) {
  const char letter = character.front();
  if (letter < ' ' || letter > '~') return kOtherWidth;
  return (bold ? kBold : kRegular)[static_cast<std::size_t>(letter - ' ')] / 1000.0;
}

}  // namespace

double text_width(std::string_view text, double size, bool bold) {
  double width = 0;
  for (const std::string_view character : characters(text)) width += width_of(character, bold);
  return width * size;
}

std::string fitted(const std::string& text, double size, bool bold, double width) {
  if (text_width(text, size, bold) <= width) return text;
  const std::vector<std::string_view> all = characters(text);
  std::string begin;
  std::string end;
  double free = width - kOtherWidth * size;
  for (std::size_t taken = 0; taken < all.size(); ++taken) {
    const bool at_begin = taken % 2 == 0;
    const std::string_view next = at_begin ? all[taken / 2] : all[all.size() - 1 - taken / 2];
    free -= width_of(next, bold) * size;
    if (free < 0) break;
    if (at_begin) {
      begin += next;
    } else {
      end.insert(0, next);
    }
  }
  return begin + std::string(kEllipsis) + end;
}

std::string xml_text(std::string_view text) {
  std::string result;
  for (const std::string_view character : characters(text)) {
    const bool is_noncharacter = character == "\uFFFE" || character == "\uFFFF";
    const std::string_view escaped = character == "&"    ? "&amp;"
                                     : character == "<"  ? "&lt;"
                                     : character == ">"  ? "&gt;"
                                     : character == "\"" ? "&quot;"
                                     : character == "'"  ? "&#39;"
                                                         : character;
    result += is_noncharacter ? "\uFFFD" : escaped;
  }
  return result;
}

std::string short_number(double value) {
  if (value > 0 && value < 0.005) return "<0.01";
  return fmt::format("{}", std::round(value * 100) / 100);
}

std::string measured(double value) {
  if (value == 0) return "0";
  return value < 0.05 ? "<0.1" : fmt::format("{:.1f}", value);
}

std::string rate_text(double frames_per_second) {
  return fmt::format("{:.{}f}", frames_per_second, frames_per_second < 100 ? 2 : 1);
}

std::string grouped(std::uint64_t count) {
  std::string text = std::to_string(count);
  if (count < 10000) return text;
  for (std::size_t place = text.size() - 3; place > 0; place -= std::min<std::size_t>(place, 3))
    text.insert(place, ",");
  return text;
}

}  // namespace stereotlm::report
