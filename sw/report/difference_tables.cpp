#include "sw/report/difference_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <numeric>
#include <regex>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "models/fpga/core_ports.h"
#include "sw/stats/console_table.h"

namespace stereotlm::report {
namespace {

using Json = nlohmann::ordered_json;

// Port, bank and cause of a wait.
using Wait = std::tuple<std::string, std::string, std::string>;

struct Rates {
  std::string kind;
  double a;
  double b;
  double uncertainty;  // of both
};

Rates rates_of(const Json& a, const Json& b) {
  for (const auto& [key, kind] : {std::pair("steady", "steady"), std::pair("system", "from power-up")}) {
    if (!a.contains(key) || !b.contains(key)) continue;
    const std::string uncertainty = std::string(key) + "_uncertainty";
    return {kind, a.at(key), b.at(key), a.value(uncertainty, 0.0) + b.value(uncertainty, 0.0)};
  }
  return {"core only", a.at("core"), b.at("core"), 0};
}

double cycles_a_frame(const Json& stats) {
  return static_cast<double>(cycles_of_frames(stats)) / stats.at("frames").get<double>();
}

std::map<Wait, double> waits_a_frame(const Json& stats) {
  std::map<Wait, double> waits;
  for (const Json& row : stats.at("blame"))
    waits[{row.at("port"), row.at("bank"), row.at("by")}] =
        row.at("cycles").get<double>() / stats.at("frames").get<double>();
  return waits;
}

// Why one run is faster. `b_is_faster`: by the rates, which need not be those of the core. A wait is named if
// its change is at least half of the change of the cycles.
std::string cause(const JudgedRun& a, const JudgedRun& b, bool b_is_faster) {
  const JudgedRun& slower = b_is_faster ? a : b;
  const JudgedRun& faster = b_is_faster ? b : a;
  const double more = cycles_a_frame(slower.stats) - cycles_a_frame(faster.stats);
  if (cycles_a_frame(slower.stats) / slower.clock_mhz <= cycles_a_frame(faster.stats) / faster.clock_mhz)
    return fmt::format("the core is not faster in {}, and the difference arises around it",
                       b_is_faster ? "B" : "A");
  if (faster.clock_mhz > slower.clock_mhz)
    return fmt::format("the core runs at {} MHz in A and at {} MHz in B", a.clock_mhz, b.clock_mhz);
  const std::map<Wait, double> before = waits_a_frame(faster.stats);
  std::pair<Wait, double> largest = {{}, 0};
  for (const auto& [wait, cycles] : waits_a_frame(slower.stats)) {
    const auto found = before.find(wait);
    const double longer = cycles - (found == before.end() ? 0 : found->second);
    if (longer > largest.second) largest = {wait, longer};
  }
  if (largest.second >= more / 2) {
    const auto& [port, bank, by] = largest.first;
    return fmt::format("in {} {} waits {:.0f} cycles a frame more on {} for {}", b_is_faster ? "A" : "B",
                       port, largest.second, platform::bank_text(bank), stats::cause_text(by));
  }
  return fmt::format("a frame takes {:.0f} cycles in A, limited by {}, and {:.0f} in B, limited by {}",
                     cycles_a_frame(a.stats), stats::resource_text(a.stats.at("bound").at("core_limited_by")),
                     cycles_a_frame(b.stats),
                     stats::resource_text(b.stats.at("bound").at("core_limited_by")));
}

std::string pixels_text(const stats::PixelComparison* pixels) {
  if (pixels == nullptr || pixels->frames() == 0) return "the disparities are not compared";
  return pixels->first() ? "the disparities differ" : "the disparities are the same";
}

constexpr std::size_t kLabelColumns = 42;
constexpr std::size_t kSettingColumns = 26;

// The value of one run in a row of differing_values().
std::string text_of(const Json& row, const char* run) {
  if (!row.contains(run)) return "-";
  const Json& value = row[run];
  if (value.is_string()) return value.get<std::string>();
  return value.is_number_integer() ? value.dump() : fmt::format("{:.6g}", value.get<double>());
}

// Whether a row of differing_values() has two real numbers that read the same.
bool reads_same(const Json& row) {
  return row.size() == 3 && row["a"].is_number_float() && row["b"].is_number_float() &&
         text_of(row, "a") == text_of(row, "b");
}

std::string signed_text(std::int64_t value) { return value == 0 ? "0" : fmt::format("{:+}", value); }

// B - A as text; empty if a value is no number or is missing in one run.
std::string difference_text(const Json& row) {
  if (!row.contains("a") || !row.contains("b")) return "";
  const Json& a = row["a"];
  const Json& b = row["b"];
  if (!a.is_number() || !b.is_number()) return "";
  if (a.is_number_integer() && b.is_number_integer())
    return signed_text(b.get<std::int64_t>() - a.get<std::int64_t>());
  return fmt::format("{:+.6g}", b.get<double>() - a.get<double>());
}

std::string line(const std::string& label, const std::string& a, const std::string& b,
                 const std::string& difference) {
  std::string text = fmt::format("{:<{}} {:>17} {:>17} {:>17}", label, kLabelColumns, a, b, difference);
  text.erase(text.find_last_not_of(' ') + 1);
  return text + '\n';
}

std::string head_line(const std::string& label) { return line(label, "A", "B", "difference"); }

std::uint64_t magnitude(std::int64_t value) { return static_cast<std::uint64_t>(std::llabs(value)); }

struct FrameLine {
  std::uint64_t frames = 0;
  std::uint64_t first = 0;
  std::uint64_t a = 0;
  std::uint64_t b = 0;

  std::int64_t difference() const { return static_cast<std::int64_t>(b - a); }
  std::int64_t in_all() const { return difference() * static_cast<std::int64_t>(frames); }
};

std::string rows_text(const stats::RowComparison::Range& range) {
  return range.first_row == range.last_row ? fmt::format("{}", range.first_row)
                                           : fmt::format("{}..{}", range.first_row, range.last_row);
}

std::string each_text(const stats::RowComparison::Range& range) {
  return range.least == range.most ? signed_text(range.least)
                                   : fmt::format("{}..{}", signed_text(range.least), signed_text(range.most));
}

}  // namespace

std::uint64_t cycles_of_frames(const Json& stats) {
  const std::vector<std::uint64_t> frames = stats.at("frame_cycles");
  return std::accumulate(frames.begin(), frames.end(), std::uint64_t{0});
}

std::string loss_text(const Json& a, const Json& b) {
  std::vector<std::uint64_t> lost;
  for (const Json* const stats : {&a, &b}) {
    lost.push_back(0);
    for (const Json& camera : stats->value("cameras", Json::array()))
      lost.back() += camera.at("dropped_pixels").get<std::uint64_t>();
  }
  if (lost[0] + lost[1] == 0) return "";
  return fmt::format(", with {} lost pixels in A and {} in B", lost[0], lost[1]);
}

std::string diff_verdict(const JudgedRun& a, const JudgedRun& b, const stats::PixelComparison* pixels) {
  Rates rates = rates_of(a.stats.at("frames_per_second"), b.stats.at("frames_per_second"));
  rates.kind += loss_text(a.stats, b.stats);
  if (rates.a == rates.b) {
    return fmt::format("A and B are equally fast, {:.3f} frames/s, {}; {}.", rates.a, rates.kind,
                       pixels_text(pixels));
  }
  const bool b_is_faster = rates.b > rates.a;
  const std::string why = cause(a, b, b_is_faster) + "; " + pixels_text(pixels);
  const double gain = std::abs(rates.b - rates.a);
  constexpr double kShown = 0.0005;  // frames/s; less rounds to 0.000
  if (gain < kShown)
    return fmt::format("A and B are equally fast to 0.001 frames/s, {}: {}.", rates.kind, why);
  if (gain <= rates.uncertainty)
    return fmt::format("A and B are equally fast within the uncertainty of {:.3f} frames/s, {}: {}.",
                       rates.uncertainty, rates.kind, why);
  return fmt::format("{} is faster by {:.3f} frames/s ({:.2f} %), {}: {}.", b_is_faster ? "B" : "A", gain,
                     100 * gain / std::min(rates.a, rates.b), rates.kind, why);
}

Json differing_values(const Values& a, const Values& b) {
  Json rows = Json::array();
  const auto add = [&rows](const platform::BoardValue* in_a, const platform::BoardValue* in_b) {
    Json row = {{"path", in_a == nullptr ? in_b->path : in_a->path}};
    for (const auto& [run, value] : {std::pair("a", in_a), std::pair("b", in_b)}) {
      if (value != nullptr) std::visit([&row, key = run](const auto& its) { row[key] = its; }, value->value);
    }
    rows.push_back(std::move(row));
  };
  const auto find = [](const Values& values, const std::string& path) -> const platform::BoardValue* {
    const auto found = std::find_if(values.begin(), values.end(),
                                    [&](const platform::BoardValue& value) { return value.path == path; });
    return found == values.end() ? nullptr : &*found;
  };
  for (const platform::BoardValue& value : a) {
    const platform::BoardValue* const other = find(b, value.path);
    if (other == nullptr || other->value != value.value) add(&value, other);
  }
  for (const platform::BoardValue& value : b) {
    if (find(a, value.path) == nullptr) add(nullptr, &value);
  }
  return rows;
}

Json shown_values(const Json& rows) {
  static const std::regex kAlways("(.*banks\\.(.*)\\.)(words|reads)");  // what every bank has
  std::map<std::string, std::string> banks;                             // of one run
  Json shown = rows;
  for (const Json& row : rows) {
    const auto path = row["path"].get<std::string>();
    std::smatch found;
    if (row.size() == 3 || !std::regex_match(path, found, kAlways)) continue;
    std::string& names = banks[row.contains("a") ? "banks only in A" : "banks only in B"];
    names += (names.empty() ? "" : ", ") + found[2].str();
    const auto is_of_bank = [head = found[1].str()](const Json& each) {
      return each["path"].get<std::string>().rfind(head, 0) == 0;
    };
    shown.erase(std::remove_if(shown.begin(), shown.end(), is_of_bank), shown.end());
  }
  for (const auto& [path, names] : banks) shown.push_back({{"path", path}, {"banks", names}});
  return shown;
}

std::string settings_table(const std::string& head, const Json& rows) {
  if (rows.empty()) return "";
  std::string text = fmt::format("{:<{}} {:<{}} {}\n", head, kLabelColumns, "A", kSettingColumns, "B");
  for (std::size_t i = 0; i < std::min(rows.size(), kMostSettings); ++i) {
    const auto path = rows[i]["path"].get<std::string>();
    const bool is_close = reads_same(rows[i]);
    const std::string of_a = is_close ? rows[i]["a"].dump() : text_of(rows[i], "a");
    const std::string of_b = is_close ? rows[i]["b"].dump() : text_of(rows[i], "b");
    if (rows[i].contains("banks")) {
      text += fmt::format("  {}: {}\n", path, rows[i]["banks"].get<std::string>());
    } else if (std::max(of_a.size(), of_b.size()) <= kSettingColumns) {
      text += fmt::format("  {:<{}} {:<{}} {}\n", path, kLabelColumns - 2, of_a, kSettingColumns, of_b);
    } else {
      text += fmt::format("  {}\n    A  {}\n    B  {}\n", path, of_a, of_b);
    }
  }
  return rows.size() <= kMostSettings ? text : text + fmt::format("  {} more\n", rows.size() - kMostSettings);
}

std::string figures_table(const std::string& head, const Json& rows) {
  std::string text;
  for (const Json& row : rows) {
    if (reads_same(row)) continue;
    text += line("  " + row["path"].get<std::string>(), text_of(row, "a"), text_of(row, "b"),
                 difference_text(row));
  }
  return text.empty() ? text : head_line(head) + text;
}

std::string frames_table(const std::vector<std::uint64_t>& cycles_a,
                         const std::vector<std::uint64_t>& cycles_b) {
  std::vector<FrameLine> lines;
  std::map<std::pair<std::uint64_t, std::uint64_t>, std::size_t> known;
  std::int64_t rest = 0;  // sum of the lines that are not shown
  for (std::size_t frame = 0; frame < std::min(cycles_a.size(), cycles_b.size()); ++frame) {
    const auto [entry, is_new] = known.emplace(std::pair(cycles_a[frame], cycles_b[frame]), lines.size());
    if (is_new) lines.push_back({0, frame, cycles_a[frame], cycles_b[frame]});
    FrameLine& line = lines[entry->second];
    ++line.frames;
    rest += line.difference();
  }
  const auto is_same = [](const FrameLine& line) { return line.a == line.b; };
  if (std::all_of(lines.begin(), lines.end(), is_same)) return "";
  const std::size_t shown = std::min(lines.size(), kMostLines);
  const auto end = lines.begin() + static_cast<std::ptrdiff_t>(shown);
  std::stable_sort(lines.begin(), lines.end(), [](const FrameLine& x, const FrameLine& y) {
    return magnitude(x.in_all()) > magnitude(y.in_all());
  });
  std::sort(lines.begin(), end, [](const FrameLine& x, const FrameLine& y) { return x.first < y.first; });
  std::string text = head_line("cycles of a frame");
  for (auto frame = lines.begin(); frame != end; ++frame) {
    const std::string label =
        frame->frames == 1 ? fmt::format("  frame {}", frame->first)
                           : fmt::format("  each of {} frames, the first is {}", frame->frames, frame->first);
    text += line(label, fmt::format("{}", frame->a), fmt::format("{}", frame->b),
                 signed_text(frame->difference()));
    rest -= frame->in_all();
  }
  if (shown == lines.size()) return text;
  return text + line(fmt::format("  {} more lines, in all", lines.size() - shown), "", "", signed_text(rest));
}

std::string rows_table(const stats::RowComparison& rows) {
  std::string text;
  if (const auto& parting = rows.parting()) {
    text = fmt::format("they part in frame {}, row {}: whole after {} cycles in A, {} in B\n", parting->frame,
                       parting->row, parting->cycles_a, parting->cycles_b);
  } else if (const auto& first = rows.other_stalls()) {
    text = fmt::format(
        "every row is whole after as many cycles in both; the waits differ from frame {}, row {} on\n",
        first->frame, first->row);
  }
  const std::vector<stats::RowComparison::Range> ranges = rows.ranges(kMostLines);
  if (ranges.empty()) return text;  // no difference, or differences of frames cancel out
  text += fmt::format("{:>43}waiting cycles of\n{:<11} {:>11} {:>15}", "", "rows", "difference", "each row");
  for (std::size_t group = 0; group < fpga::kCoreGroupCount; ++group)
    text += fmt::format(" {:>11}", fpga::kPortGroups[group].name);
  text += '\n';
  for (const stats::RowComparison::Range& range : ranges) {
    text +=
        fmt::format("  {:<9} {:>11} {:>15}", rows_text(range), signed_text(range.cycles), each_text(range));
    for (const std::int64_t stalls : range.stalls) text += fmt::format(" {:>11}", signed_text(stalls));
    text += '\n';
  }
  return text;
}

Json differing_waits(const std::vector<platform::BlameRow>& a, const std::vector<platform::BlameRow>& b) {
  std::map<Wait, std::pair<std::int64_t, std::int64_t>> all;
  for (const platform::BlameRow& row : a)
    all[{row.port, row.bank, row.by}].first = static_cast<std::int64_t>(row.cycles);
  for (const platform::BlameRow& row : b)
    all[{row.port, row.bank, row.by}].second = static_cast<std::int64_t>(row.cycles);
  std::vector<Json> waits;
  for (const auto& [wait, cycles] : all) {
    const auto& [port, bank, by] = wait;
    if (cycles.first == cycles.second) continue;
    waits.push_back({{"port", port}, {"bank", bank}, {"by", by}, {"a", cycles.first}, {"b", cycles.second}});
  }
  const auto size = [](const Json& wait) {
    return magnitude(wait["b"].get<std::int64_t>() - wait["a"].get<std::int64_t>());
  };
  std::stable_sort(waits.begin(), waits.end(),
                   [&](const Json& x, const Json& y) { return size(x) > size(y); });
  return waits;
}

std::string blame_table(const Json& waits) {
  std::string text;
  for (const Json& wait : waits)
    text += line("  " + stats::wait_text(wait["port"], wait["bank"], wait["by"]), text_of(wait, "a"),
                 text_of(wait, "b"), difference_text(wait));
  return text.empty() ? text : head_line("waits, cycles") + text;
}

std::string pixels_line(const stats::PixelComparison& pixels) {
  if (pixels.frames() == 0) return "disparities: not compared: no camera frame is in both\n";
  const std::string frames = fmt::format("{} frame{}", pixels.frames(), pixels.frames() == 1 ? "" : "s");
  if (!pixels.first()) return fmt::format("disparities: the same, pixel for pixel, in {}\n", frames);
  const stats::PixelComparison::First& first = *pixels.first();
  return fmt::format(
      "disparities: {} pixel{} differ{}, in {} of {}; the first in frame {} at ({}, {}): {} in A, {} in B\n",
      pixels.pixels(), pixels.pixels() == 1 ? "" : "s", pixels.pixels() == 1 ? "s" : "",
      pixels.frames_that_differ(), frames, first.camera_frame, first.column, first.row, first.a, first.b);
}

}  // namespace stereotlm::report
