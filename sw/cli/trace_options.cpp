#include "sw/cli/trace_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

namespace stereotlm::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kWindowForms =
    "frame=F, frame=F,rows=A..B, frame=F,cycles=A..B or cycles=A..B, with integers and A not above B; each "
    "may "
    "end with ,longest-wait";

std::vector<std::string_view> parts_of(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (;;) {
    const std::size_t end = text.find(separator);
    parts.push_back(text.substr(0, end));
    if (end == std::string_view::npos) return parts;
    text.remove_prefix(end + 1);
  }
}

// "A..B" as the limits of the window. Returns false if it is none.
bool read_range(std::string_view text, fpga::CycleWindow& window) {
  const std::size_t dots = text.find("..");
  if (dots == std::string_view::npos) return false;
  const auto first = number_of<std::uint64_t>(text.substr(0, dots));
  const auto last = number_of<std::uint64_t>(text.substr(dots + 2));
  if (!first || !last || *first > *last) return false;
  window.first = *first;
  window.last = *last;
  return true;
}

// Nothing if the text has none of the forms.
std::optional<trace::TraceWindow> window_of(std::string_view text) {
  trace::TraceWindow found;
  fpga::CycleWindow& window = found.cycles;
  bool has_range = false;
  for (const std::string_view part : parts_of(text, ',')) {
    if (found.around_longest_wait) return std::nullopt;  // was not the last part
    const std::size_t equals = std::min(part.find('='), part.size());
    const std::string_view key = part.substr(0, equals);
    const std::string_view value = part.substr(std::min(equals + 1, part.size()));
    if (part == "longest-wait" && (has_range || window.frame)) {
      found.around_longest_wait = true;
    } else if (key == "frame" && !window.frame) {
      window.frame = number_of<std::uint64_t>(value);
      if (!window.frame) return std::nullopt;
    } else if ((key == "rows" || key == "cycles") && !has_range) {
      has_range = true;
      if (key == "rows") window.unit = fpga::CycleWindow::Unit::kRows;
      if (!read_range(value, window)) return std::nullopt;
    } else {
      return std::nullopt;
    }
  }
  if (window.unit == fpga::CycleWindow::Unit::kRows && !window.frame) return std::nullopt;
  return found;
}

std::vector<std::string> format_names() {
  std::vector<std::string> names;
  for (const trace::TraceFormat& format : trace::kTraceFormats) names.emplace_back(format.name);
  return names;
}

}  // namespace

void TraceOptions::add_to(CLI::App& command) {
  files_.add_to(
      command, "--trace", "FORMAT:FILE",
      fmt::format("Write a trace of the run; FORMAT is {}; repeat it for more traces; a vcd whose FILE "
                  "ends in .fst becomes FST",
                  fmt::join(format_names(), ", ")));
  files_.takes_one_at_a_time();
  window_.add_to(
      command, "--trace-window", "WINDOW",
      "Trace each cycle of a part of the run: frame=F[,rows=A..B | ,cycles=A..B] or cycles=A..B, the "
      "limits included; frames and rows count from 0, cycles from the frame's first or from power-up; "
      "with ,longest-wait only the cycles around the longest wait in it; vcd needs a window");
}

void TraceOptions::check_usage(process::Problems& problems) {
  if (files_.is_given()) check_files(problems);
  if (!window_.is_given()) return;
  window = window_of(window_.text);
  if (!window) problems.add(fmt::format("--trace-window = '{}': must be {}", window_.text, kWindowForms));
  if (!files_.is_given()) problems.add("--trace-window: goes with --trace FORMAT:FILE");
}

// A file that the trace would write, and another trace too; nothing if there is none.
std::optional<std::filesystem::path> TraceOptions::shared_output(const trace::TraceFile& file) const {
  try {
    for (const fs::path& output : trace::outputs_of(file)) {
      for (const trace::TraceFile& other : files) {
        const std::vector<fs::path> others = trace::outputs_of(other);
        if (std::find(others.begin(), others.end(), output) != others.end()) return output;
      }
    }
  } catch (const std::system_error&) {  // trace::Trace says why
  }
  return std::nullopt;
}

void TraceOptions::check_files(process::Problems& problems) {
  for (const std::string& text : files_.text) {
    const std::size_t colon = text.find(':');
    const auto* const format =
        std::find_if(std::begin(trace::kTraceFormats), std::end(trace::kTraceFormats),
                     [&](const trace::TraceFormat& each) { return each.name == text.substr(0, colon); });
    if (colon == std::string::npos || format == std::end(trace::kTraceFormats) || colon + 1 == text.size()) {
      problems.add(fmt::format("--trace '{}': must be FORMAT:FILE, where FORMAT is {}", text,
                               platform::listed(format_names())));
      continue;
    }
    trace::TraceFile file{format, text.substr(colon + 1)};
    if (const auto shared = shared_output(file)) {
      problems.add(fmt::format("--trace '{}': '{}' is the file of two traces: each needs its own", text,
                               shared->string()));
    }
    if (format->needs_window && !window_.is_given())
      problems.add(fmt::format("--trace '{}': needs --trace-window: a {} has only the cycles of a window",
                               text, format->name));
    files.push_back(std::move(file));
  }
}

void TraceOptions::check_window(const platform::BoardConfig& board, std::uint64_t frames,
                                process::Problems& problems) const {
  if (!window) return;
  const fpga::CycleWindow& cycles = window->cycles;
  if (cycles.frame && *cycles.frame >= frames) {
    problems.add(fmt::format("--trace-window = '{}': frame {}: must be below the frames of the run, {}",
                             window_.text, *cycles.frame, frames));
  }
  const auto height = static_cast<std::uint64_t>(board.image.height);
  if (cycles.unit == fpga::CycleWindow::Unit::kRows && cycles.last >= height) {
    problems.add(fmt::format("--trace-window = '{}': row {}: must be below the rows of the image, {}",
                             window_.text, cycles.last, height));
  }
}

}  // namespace stereotlm::cli
