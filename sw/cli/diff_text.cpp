#include "sw/cli/diff_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <utility>
#include <variant>
#include <vector>

#include "models/fpga/core_ports.h"
#include "platform/config/board_yaml.h"
#include "sw/cli/text.h"
#include "sw/explore/plan/figures.h"
#include "sw/report/difference_tables.h"

namespace stereotlm::cli {
namespace {

using Json = nlohmann::ordered_json;
using report::Values;

// All values of run.json by path.
Values options_of(const runs::RecordedRun& run) {
  Values values;
  const Json flat = Json::parse(run.run_json).flatten();
  for (const auto& [path, value] : flat.items()) {
    std::string name = path.substr(1);
    std::replace(name.begin(), name.end(), '/', '.');
    values.push_back({name, value.is_string() ? value.get<std::string>() : value.dump()});
  }
  return values;
}

// The figures of a run by path in stats.json.
struct RunFigures {
  explicit RunFigures(const runs::RecordedRun& run) : document(Json::parse(run.stats_json)) {
    for (platform::BoardValue& value : explore::figures_of(document).values) {
      // Leaves out figures that follow from others, and frame_cycles, which is compared frame by frame.
      const auto ends_in = [&value](const std::string& key) {
        return value.path.size() >= key.size() &&
               value.path.compare(value.path.size() - key.size(), key.size(), key) == 0;
      };
      if (ends_in(".utilization") || ends_in(".megabytes_per_second") || value.path == "frame_cycles")
        continue;
      if (value.path == "cycles") value.value = static_cast<std::int64_t>(report::cycles_of_frames(document));
      values.push_back(std::move(value));
    }
  }

  // The figures whose paths begin with one of `keys`. If there is only one key, the paths in the result omit
  // it.
  Values below(const std::vector<std::string>& keys) const {
    Values found;
    for (platform::BoardValue value : values) {
      const std::size_t dot = value.path.find('.');
      if (std::find(keys.begin(), keys.end(), value.path.substr(0, dot)) == keys.end()) continue;
      if (keys.size() == 1) {
        value.path.erase(0, dot + 1);
        std::replace(value.path.begin(), value.path.end(), '.', ' ');
      }
      found.push_back(std::move(value));
    }
    return found;
  }
  std::vector<std::uint64_t> frame_cycles() const { return document.at("frame_cycles"); }
  std::vector<platform::BlameRow> blame() const {
    std::vector<platform::BlameRow> rows;
    for (const Json& row : document.at("blame"))
      rows.push_back({row.at("port"), row.at("bank"), row.at("by"), row.at("cycles")});
    return rows;
  }
  bool has_computer() const { return document.contains("pci"); }

  Json document;
  Values values;
};

std::string figures_text(const std::string& head, const RunFigures& a, const RunFigures& b) {
  return report::figures_table(head, a.below({head}), b.below({head}));
}

// Joins the texts that are not empty, with an empty line between them.
std::string in_sections(const std::vector<std::string>& texts) {
  std::string all;
  for (const std::string& text : texts) {
    if (!text.empty()) all += (all.empty() ? "" : "\n") + text;
  }
  return all;
}

std::string totals_text(const RunFigures& a, const RunFigures& b) {
  const std::vector<std::string> keys = {"frames", "cycles", "frames_per_second", "bound", "accuracy"};
  std::string text = report::figures_table("totals", a.below(keys), b.below(keys));
  const std::size_t of_a = a.frame_cycles().size();
  const std::size_t of_b = b.frame_cycles().size();
  if (of_a != of_b) {
    text +=
        fmt::format("figures are of all {} frames of A and all {} of B, cycles and rows of the first {}\n",
                    of_a, of_b, std::min(of_a, of_b));
  }
  return text;
}

std::string computer_text(const RunFigures& a, const RunFigures& b) {
  if (a.has_computer() != b.has_computer())
    return fmt::format("pci, bridge, cameras and latency: only in {}\n", a.has_computer() ? "A" : "B");
  return in_sections({figures_text("pci", a, b), figures_text("bridge", a, b), figures_text("cameras", a, b),
                      figures_text("latency_ms", a, b)});
}

std::string verdict_of(const runs::RecordedRun& run_a, const runs::RecordedRun& run_b, const RunFigures& a,
                       const RunFigures& b, const runs::FrameAlignment& aligned,
                       const runs::DiffLimits& limits) {
  return report::diff_verdict({a.document, run_a.board.fpga.clock_mhz},
                              {b.document, run_b.board.fpga.clock_mhz},
                              limits.pixels.empty() ? &aligned.pixels() : nullptr);
}

Json differing_json(const Values& a, const Values& b) {
  Json list = Json::array();
  for (const report::Differing& each : report::differing(a, b)) {
    Json json = {{"path", each.path}};
    for (const auto& [name, value] : {std::pair("a", each.a), std::pair("b", each.b)}) {
      if (value != nullptr) std::visit([&json, key = name](const auto& its) { json[key] = its; }, *value);
    }
    list.push_back(std::move(json));
  }
  return list;
}

Json frames_json(const std::vector<std::uint64_t>& a, const std::vector<std::uint64_t>& b) {
  Json list = Json::array();
  for (std::size_t frame = 0; frame < std::min(a.size(), b.size()); ++frame) {
    if (a[frame] != b[frame]) list.push_back({{"frame", frame}, {"a", a[frame]}, {"b", b[frame]}});
  }
  return list;
}

Json waits_json(const std::vector<platform::BlameRow>& a, const std::vector<platform::BlameRow>& b) {
  Json list = Json::array();
  for (const report::DifferingWait& wait : report::differing_waits(a, b))
    list.push_back({{"port", wait.row.port},
                    {"bank", wait.row.bank},
                    {"by", wait.row.by},
                    {"a", wait.a},
                    {"b", wait.b}});
  return list;
}

Json json_of(const stats::RowComparison& rows) {
  Json ranges = Json::array();
  for (const stats::RowComparison::Range& range : rows.ranges(report::kMostLines)) {
    Json waits = Json::object();
    for (std::size_t port = 0; port < fpga::kCorePortCount; ++port)
      waits[fpga::kPorts[port].name] = range.stalls[port];
    ranges.push_back({{"first_row", range.first_row},
                      {"last_row", range.last_row},
                      {"cycles", range.cycles},
                      {"waiting_cycles", std::move(waits)}});
  }
  return {{"frames", rows.frames()}, {"ranges", std::move(ranges)}};
}

Json json_of(const stats::PixelComparison& pixels) {
  return {{"frames", pixels.frames()},
          {"frames_that_differ", pixels.frames_that_differ()},
          {"pixels_that_differ", pixels.pixels()}};
}

}  // namespace

std::string diff_text(const runs::RecordedRun& run_a, const runs::RecordedRun& run_b,
                      const runs::FrameAlignment& aligned, const runs::DiffLimits& limits) {
  const RunFigures a(run_a);
  const RunFigures b(run_b);
  const std::string settings = in_sections(
      {report::settings_table("board", platform::values_of(run_a.board), platform::values_of(run_b.board)),
       report::settings_table("run options", options_of(run_a), options_of(run_b))});
  const std::string rows = limits.rows.empty() ? report::rows_table(aligned.rows())
                                               : fmt::format("rows: not compared: {}\n", limits.rows);
  std::string figures =
      in_sections({totals_text(a, b), report::frames_table(a.frame_cycles(), b.frame_cycles()), rows,
                   report::blame_table(a.blame(), b.blame()), figures_text("ports", a, b),
                   figures_text("banks", a, b), computer_text(a, b), figures_text("area", a, b)});
  if (figures.empty()) figures = settings.empty() ? "no difference\n" : "no figure and no row differs\n";
  const std::string pixels = limits.pixels.empty()
                                 ? report::pixels_line(aligned.pixels())
                                 : fmt::format("disparities: not compared: {}\n", limits.pixels);
  return in_sections({fmt::format("A: {}\nB: {}\n", run_a.folder, run_b.folder), settings, figures, pixels,
                      paragraph("", 0, verdict_of(run_a, run_b, a, b, aligned, limits))});
}

Json diff_document(const runs::RecordedRun& run_a, const runs::RecordedRun& run_b,
                   const runs::FrameAlignment& aligned, const runs::DiffLimits& limits) {
  const RunFigures a(run_a);
  const RunFigures b(run_b);
  return {{"schema", 1},
          {"a", run_a.folder},
          {"b", run_b.folder},
          {"settings", differing_json(platform::values_of(run_a.board), platform::values_of(run_b.board))},
          {"options", differing_json(options_of(run_a), options_of(run_b))},
          {"figures", differing_json(a.values, b.values)},
          {"frames", frames_json(a.frame_cycles(), b.frame_cycles())},
          {"waits", waits_json(a.blame(), b.blame())},
          {"rows", limits.rows.empty() ? json_of(aligned.rows()) : Json{{"not_compared", limits.rows}}},
          {"disparities",
           limits.pixels.empty() ? json_of(aligned.pixels()) : Json{{"not_compared", limits.pixels}}},
          {"verdict", verdict_of(run_a, run_b, a, b, aligned, limits)}};
}

}  // namespace stereotlm::cli
