#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "models/fpga/core_ports.h"
#include "platform/config/board_yaml.h"
#include "sw/cli/command.h"
#include "sw/explore/store/store.h"
#include "sw/process/interrupt.h"
#include "sw/process/streams.h"
#include "sw/report/difference_tables.h"
#include "sw/runs/recorded_run.h"
#include "sw/stats/run_comparison.h"

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
  explicit RunFigures(const runs::RecordedRun& run)
      : statistics(run.statistics), document(Json::parse(run.stats_json)) {
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

  const platform::Statistics& statistics;
  Json document;
  Values values;
};

// The rows of differing_values() whose paths begin with one of `keys`.
Json below(const Json& figures, const std::vector<std::string>& keys) {
  Json found = Json::array();
  for (const Json& row : figures) {
    const auto path = row["path"].get<std::string>();
    if (std::find(keys.begin(), keys.end(), path.substr(0, path.find('.'))) != keys.end())
      found.push_back(row);
  }
  return found;
}

// The table of the figures below a key, which their paths there omit.
std::string figures_text(const std::string& key, const Json& figures) {
  Json rows = below(figures, {key});
  for (Json& row : rows) {
    std::string path = row["path"].get<std::string>().erase(0, key.size() + 1);
    std::replace(path.begin(), path.end(), '.', ' ');
    row["path"] = path;
  }
  return report::figures_table(key, rows);
}

// Joins the texts that are not empty, with an empty line between them.
std::string in_sections(const std::vector<std::string>& texts) {
  std::string all;
  for (const std::string& text : texts) {
    if (!text.empty()) all += (all.empty() ? "" : "\n") + text;
  }
  return all;
}

std::string totals_text(const RunFigures& a, const RunFigures& b, const Json& figures) {
  std::string text = report::figures_table(
      "totals", below(figures, {"frames", "cycles", "frames_per_second", "bound", "accuracy"}));
  const std::size_t of_a = a.statistics.frame_cycles.size();
  const std::size_t of_b = b.statistics.frame_cycles.size();
  if (of_a != of_b) {
    text +=
        fmt::format("figures are of all {} frames of A and all {} of B, cycles and rows of the first {}\n",
                    of_a, of_b, std::min(of_a, of_b));
  }
  return text;
}

std::string computer_text(const RunFigures& a, const RunFigures& b, const Json& figures) {
  const bool a_has_computer = a.statistics.computer.has_value();
  if (a_has_computer != b.statistics.computer.has_value())
    return fmt::format("pci, bridge, cameras and latency: only in {}\n", a_has_computer ? "A" : "B");
  return in_sections({figures_text("pci", figures), figures_text("bridge", figures),
                      figures_text("cameras", figures), figures_text("latency_ms", figures)});
}

Json frames_json(const std::vector<std::uint64_t>& a, const std::vector<std::uint64_t>& b) {
  Json list = Json::array();
  for (std::size_t frame = 0; frame < std::min(a.size(), b.size()); ++frame) {
    if (a[frame] != b[frame]) list.push_back({{"frame", frame}, {"a", a[frame]}, {"b", b[frame]}});
  }
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

Json diff_document(const runs::RecordedRun& run_a, const runs::RecordedRun& run_b, const RunFigures& a,
                   const RunFigures& b, const runs::FrameAlignment& aligned, const runs::DiffLimits& limits) {
  return {{"schema", 1},
          {"a", run_a.folder},
          {"b", run_b.folder},
          {"settings",
           report::differing_values(platform::values_of(run_a.board), platform::values_of(run_b.board))},
          {"options", report::differing_values(options_of(run_a), options_of(run_b))},
          {"figures", report::differing_values(a.values, b.values)},
          {"frames", frames_json(a.statistics.frame_cycles, b.statistics.frame_cycles)},
          {"waits", report::differing_waits(a.statistics.blame, b.statistics.blame)},
          {"rows", limits.rows.empty() ? json_of(aligned.rows()) : Json{{"not_compared", limits.rows}}},
          {"disparities",
           limits.pixels.empty() ? json_of(aligned.pixels()) : Json{{"not_compared", limits.pixels}}},
          {"verdict", report::diff_verdict({a.document, run_a.board.fpga.clock_mhz},
                                           {b.document, run_b.board.fpga.clock_mhz},
                                           limits.pixels.empty() ? &aligned.pixels() : nullptr)}};
}

std::string diff_text(const runs::RecordedRun& run_a, const runs::RecordedRun& run_b,
                      const runs::FrameAlignment& aligned, const runs::DiffLimits& limits) {
  const RunFigures a(run_a);
  const RunFigures b(run_b);
  const Json document = diff_document(run_a, run_b, a, b, aligned, limits);
  const std::string settings = in_sections({report::settings_table("board", document["settings"]),
                                            report::settings_table("run options", document["options"])});
  const Json& all = document["figures"];
  const std::string rows = limits.rows.empty() ? report::rows_table(aligned.rows())
                                               : fmt::format("rows: not compared: {}\n", limits.rows);
  std::string figures = in_sections(
      {totals_text(a, b, all), report::frames_table(a.statistics.frame_cycles, b.statistics.frame_cycles),
       rows, report::blame_table(document["waits"]), figures_text("ports", all), figures_text("banks", all),
       computer_text(a, b, all), figures_text("area", all)});
  if (figures.empty()) figures = settings.empty() ? "no difference\n" : "no figure and no row differs\n";
  const std::string pixels = limits.pixels.empty()
                                 ? report::pixels_line(aligned.pixels())
                                 : fmt::format("disparities: not compared: {}\n", limits.pixels);
  return in_sections({fmt::format("A: {}\nB: {}\n", run_a.folder, run_b.folder), settings, figures, pixels,
                      paragraph("", 0, document["verdict"])});
}

constexpr const char* kRunFolder = "a folder that run --out has written";
constexpr const char* kDiffFooter =
    "Both are run again from their config.yaml and run.json, after a check of every input by its\n"
    "SHA-256, and must give the figures of their stats.json. What is not the same is printed;\n"
    "differences are B - A. A row of results is whole with the write of its last word. Its cycles are\n"
    "those since the row above was whole, those of the top row since the frame began; in the table of\n"
    "rows they are sums over the frames. The last line says which run is faster, and where the difference\n"
    "arises.";

struct DiffOptions : Options {
  using Options::Options;

  Option a = Option(this, "A", " ", "A folder that run --out has written", {required(kRunFolder)});
  Option b = Option(this, "B", " ", "Another one", {required(kRunFolder)});
  Option csv = Option(this, "--csv", "F.csv", "Write the cycles and waits of every frame and row of both",
                      {ends_in(".csv")});
  JsonOption json{this};
};

int diff(const DiffOptions& options) {
  process::catch_interrupts();
  process::Problems problems;
  const auto a = runs::load_recorded_run("A", options.a.text(), problems);
  const auto b = runs::load_recorded_run("B", options.b.text(), problems);
  problems.check();
  for (const runs::RecordedRun& run : {std::cref(*a), std::cref(*b)}) runs::open_again(run, problems);
  const runs::DiffLimits limits(*a, *b);
  std::unique_ptr<stats::RowsCsv> csv;
  if (options.csv.is_given()) {
    if (!limits.rows.empty()) problems.add(fmt::format("--csv: rows cannot be compared: {}", limits.rows));
    problems.attempt("--csv ", [&] { csv = std::make_unique<stats::RowsCsv>(options.csv.text()); });
  }
  problems.check();
  runs::FrameAlignment aligned(*a, *b, limits, csv.get());
  if (!aligned.run()) return interrupted("nothing is compared");
  if (csv) csv->commit();
  if (options.json.is_given()) {
    print_json(diff_document(*a, *b, RunFigures(*a), RunFigures(*b), aligned, limits));
  } else {
    const std::string text = diff_text(*a, *b, aligned, limits);
    process::print(with_coloured_words(text, text.rfind("\n\n"),
                                       {{"is faster", process::Colour::kGreen},
                                        {"equally fast", process::Colour::kGreen},
                                        {"are the same", process::Colour::kGreen},
                                        {"differ.", process::Colour::kYellow}}));
  }
  return kDone;
}

}  // namespace

void add_diff(CLI::App& program, Action& action) {
  add_command(program, action, "diff", "Compare two runs, frame by frame and row by row", diff, kDiffFooter);
}

}  // namespace stereotlm::cli
