#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "sw/cli/command.h"
#include "sw/report/difference_tables.h"
#include "sw/report/page_data/page_data.h"
#include "sw/runs/recorded_run.h"
#include "sw/stats/run_comparison.h"

namespace stereotlm::cli {
namespace {

using Json = nlohmann::ordered_json;

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

std::string totals_text(const runs::RecordedRun& a, const runs::RecordedRun& b, const Json& figures) {
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

std::string computer_text(const runs::RecordedRun& a, const runs::RecordedRun& b, const Json& figures) {
  const bool a_has_computer = a.statistics.computer.has_value();
  if (a_has_computer != b.statistics.computer.has_value())
    return fmt::format("pci, bridge, cameras and latency: only in {}\n", a_has_computer ? "A" : "B");
  return in_sections({figures_text("pci", figures), figures_text("bridge", figures),
                      figures_text("cameras", figures), figures_text("latency_ms", figures)});
}

std::string diff_text(const runs::RecordedRun& a, const runs::RecordedRun& b,
                      const runs::FrameAlignment& aligned, const runs::DiffLimits& limits) {
  const Json document = report::diff_document(a, b, aligned, limits);
  const std::string settings =
      in_sections({report::settings_table("board", report::shown_values(document["settings"])),
                   report::settings_table("run options", document["options"])});
  Json all = report::shown_values(document["figures"]);
  const bool is_lossy = platform::lost_pixels(a.statistics) + platform::lost_pixels(b.statistics) > 0;
  for (Json& row : all) {
    if (is_lossy && (row["path"] == "frames_per_second.steady" || row["path"] == "frames_per_second.system"))
      row["path"] = row["path"].get<std::string>() + ", losing pixels";
  }
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
  return in_sections({fmt::format("A: {}\nB: {}\n", a.folder, b.folder), settings, figures, pixels,
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
    process::print(json_text(report::diff_document(*a, *b, aligned, limits)));
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

void add_diff(Commands& commands) {
  add_command(commands, "diff", "Compare two runs, frame by frame and row by row", diff, kDiffFooter);
}

}  // namespace stereotlm::cli
