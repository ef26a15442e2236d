#include "sw/trace/gtkwave_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>

namespace stereotlm::trace {
namespace {

// Flags of a line, from GTKWave's analyzer.h.
constexpr unsigned kHex = 0x2;
constexpr unsigned kDecimal = 0x4;
constexpr unsigned kRight = 0x20;
constexpr unsigned kBlank = 0x200;
constexpr unsigned kAscii = 0x800;
constexpr unsigned kGroupBegin = 0x800000;
constexpr unsigned kGroupEnd = 0x1000000;

// Numbers of GTKWave's colours.
enum Color : unsigned { kNormal = 0, kOrange = 2, kYellow = 3, kGreen = 4, kIndigo = 6 };

Color color_of(const VcdSignal& signal) {
  if (signal.name == "state" || signal.name == "phase") return kYellow;
  if (signal.name == "waits_for") return kOrange;
  if (signal.bits == 0) return kGreen;
  return signal.name == "address" ? kIndigo : kNormal;
}

unsigned flags_of(const VcdSignal& signal) {
  if (signal.bits == 0) return kAscii | kRight;
  return (signal.name == "address" ? kHex : kDecimal) | kRight;
}

std::string line_of(const VcdSignal& signal) {
  const std::string range = signal.bits > 1 ? fmt::format("[{}:0]", signal.bits - 1) : "";
  // The name in braces is shown. Of a name with a point, GTKWave would show the part behind it.
  return fmt::format("[color] {0}\n@{1:x}\n+{{{2} {3}}} {2}.{3}{4}\n",
                     static_cast<unsigned>(color_of(signal)), flags_of(signal), signal.scope, signal.name,
                     range);
}

// The exponent of the zoom with which the span fills some 990 pixels: 200 pixels show 2^-zoom units of time.
double zoom_of(const VcdSpan& span) {
  constexpr double kParts = 4.95;
  return -std::log2(static_cast<double>(std::max<std::uint64_t>(span.last_ps - span.first_ps, 1)) / kParts);
}

}  // namespace

std::string gtkwave_layout(const std::string& file_name, const VcdSignals& signals, const VcdSpan& span) {
  std::string text = fmt::format(
      "{}\n[dumpfile] \"{}\"\n[timestart] {}\n[size] 1400 900\n[pos] -1 -1\n*{:.6f} {}", kLayoutMark,
      file_name, span.first_ps, zoom_of(span), span.wait_ps ? fmt::to_string(*span.wait_ps) : "-1");
  constexpr int kMarkers = 26;
  for (int marker = 0; marker < kMarkers; ++marker) text += " -1";
  text += "\n[sst_width] 60\n[signals_width] 290\n[sst_expanded] 0\n";
  for (std::size_t group = 0; group < kVcdGroupNames.size(); ++group) {
    fmt::format_to(std::back_inserter(text), "@{:x}\n-{}\n", kGroupBegin | kBlank, kVcdGroupNames[group]);
    for (const VcdSignal& signal : signals.all()) {
      if (static_cast<std::size_t>(signal.group) == group && span.active_scopes.count(signal.scope) != 0)
        text += line_of(signal);
    }
    fmt::format_to(std::back_inserter(text), "@{:x}\n-{}\n", kGroupEnd | kBlank, kVcdGroupNames[group]);
  }
  return text;
}

}  // namespace stereotlm::trace
