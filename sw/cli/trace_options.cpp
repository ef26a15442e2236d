#include "sw/cli/trace_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <regex>
#include <set>
#include <string>
#include <system_error>

#include "platform/config/board_keys.h"

namespace stereotlm::cli {
namespace {

constexpr const char* kWindowForms =
    "frame=F, frame=F,rows=A..B, frame=F,cycles=A..B or cycles=A..B, with integers and A not above B; each "
    "may "
    "end with ,longest-wait";

// nullopt if the text has none of the forms.
std::optional<trace::TraceWindow> window_of(const std::string& text) {
  static const std::regex form(
      R"((?:frame=(\d+)(?:,(rows|cycles)=(\d+)\.\.(\d+))?|cycles=(\d+)\.\.(\d+))(,longest-wait)?)");
  std::smatch match;
  if (!std::regex_match(text, match, form)) return std::nullopt;
  trace::TraceWindow found;
  fpga::CycleWindow& window = found.cycles;
  found.around_longest_wait = match[7].matched;
  if (match[2] == "rows") window.unit = fpga::CycleWindow::Unit::kRows;
  if (match[1].matched && !(window.frame = number_of<std::uint64_t>(match[1].str()))) return std::nullopt;
  const std::size_t range = match[3].matched ? 3 : 5;
  if (!match[range].matched) return found;
  const auto first = number_of<std::uint64_t>(match[range].str());
  const auto last = number_of<std::uint64_t>(match[range + 1].str());
  if (!first || !last || *first > *last) return std::nullopt;
  window.first = *first;
  window.last = *last;
  return found;
}

void is_window(const Option& option, process::Problems& problems) {
  if (option.is_given() && !window_of(option.text()))
    problems.add(fmt::format("--trace-window = '{}': must be {}", option.text(), kWindowForms));
}

std::vector<std::string> format_names() {
  std::vector<std::string> names;
  for (const trace::TraceFormat& format : trace::kTraceFormats) names.emplace_back(format.name);
  return names;
}

// nullopt if the text is not FORMAT:FILE.
std::optional<trace::TraceFile> file_of(const std::string& text) {
  const std::size_t colon = text.find(':');
  const auto* const format =
      std::find_if(std::begin(trace::kTraceFormats), std::end(trace::kTraceFormats),
                   [&](const trace::TraceFormat& each) { return each.name == text.substr(0, colon); });
  if (colon == std::string::npos || format == std::end(trace::kTraceFormats) || colon + 1 == text.size())
    return std::nullopt;
  return trace::TraceFile{format, text.substr(colon + 1)};
}

}  // namespace

TraceOptions::TraceOptions(Options* of)
    : files_(
          of, "--trace", "FORMAT:FILE",
          fmt::format("Write a trace of the run; FORMAT is {}; repeat it for more traces; a vcd whose FILE "
                      "ends in .fst becomes FST",
                      fmt::join(format_names(), ", ")),
          {}, Takes::kRepeated),
      window_(
          of, "--trace-window", "WINDOW",
          "Trace each cycle of a part of the run: frame=F[,rows=A..B | ,cycles=A..B] or cycles=A..B, the "
          "limits included; frames and rows count from 0, cycles from the frame's first or from power-up; "
          "with ,longest-wait only the cycles around the longest wait in it; vcd needs a window",
          {is_window, goes_with(files_, "FORMAT:FILE")}) {}

void TraceOptions::check_together(process::Problems& problems) const {
  std::set<std::filesystem::path> outputs;
  for (const std::string& text : files_.texts()) {
    const auto file = file_of(text);
    if (!file) {
      problems.add(fmt::format("--trace '{}': must be FORMAT:FILE, where FORMAT is {}", text,
                               platform::listed(format_names())));
      continue;
    }
    try {
      const auto own = trace::outputs_of(*file);
      const auto shared =
          std::find_if(own.begin(), own.end(),
                       [&outputs](const std::filesystem::path& output) { return outputs.count(output) > 0; });
      if (shared != own.end())
        problems.add(fmt::format("--trace '{}': '{}' is the file of two traces: each needs its own", text,
                                 shared->string()));
      outputs.insert(own.begin(), own.end());
    } catch (const std::system_error&) {  // trace::Trace says why
    }
    if (file->format->needs_window && !window_.is_given())
      problems.add(fmt::format("--trace '{}': needs --trace-window: a {} has only the cycles of a window",
                               text, file->format->name));
  }
}

void TraceOptions::check_window(const platform::BoardConfig& board, std::uint64_t frames,
                                process::Problems& problems) const {
  const auto traced = window();
  if (!traced) return;
  const fpga::CycleWindow& cycles = traced->cycles;
  if (cycles.frame && *cycles.frame >= frames) {
    problems.add(fmt::format("--trace-window = '{}': frame {}: must be below the frames of the run, {}",
                             window_.text(), *cycles.frame, frames));
  }
  const auto height = static_cast<std::uint64_t>(board.image.height);
  if (cycles.unit == fpga::CycleWindow::Unit::kRows && cycles.last >= height) {
    problems.add(fmt::format("--trace-window = '{}': row {}: must be below the rows of the image, {}",
                             window_.text(), cycles.last, height));
  }
}

std::vector<trace::TraceFile> TraceOptions::files() const {
  std::vector<trace::TraceFile> files;
  for (const std::string& text : files_.texts()) {
    if (auto file = file_of(text)) files.push_back(std::move(*file));
  }
  return files;
}

std::optional<trace::TraceWindow> TraceOptions::window() const { return window_of(window_.text()); }

}  // namespace stereotlm::cli
