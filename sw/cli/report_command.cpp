#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "sw/cli/command.h"
#include "sw/process/command.h"
#include "sw/report/difference_tables.h"
#include "sw/report/html_page.h"
#include "sw/report/page_data/page_data.h"
#include "sw/runs/explanation.h"
#include "sw/runs/recorded_run.h"
#include "sw/runs/run_results.h"
#include "sw/stats/console_table.h"

namespace stereotlm::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kReportFooter =
    "INPUT is a folder that run --out has written, a database of sweep, or two such folders, which are\n"
    "compared; these are run again. The page is one file; a browser shows it without a network. For one run\n"
    "each single change of the board is also tried, as explain does.";

struct ReportOptions : Options {
  using Options::Options;

  bool is_database() const {
    std::error_code ignored;
    return inputs.texts().size() == 1 && std::filesystem::is_regular_file(inputs.texts().front(), ignored);
  }

  void check_together(process::Problems& problems) override {
    if (out.is_given() == json.is_given())
      problems.add(out.is_given() ? "--json: does not go with --out" : "--out: missing: the page to write");
    const std::size_t count = inputs.texts().size();
    if (count > 2) problems.add(fmt::format("INPUT: {} given: one run or database, or two runs", count));
    if (quick.is_given() && count == 2)
      problems.add("--quick: not with two runs: they are compared row by row");
    if (quick.is_given() && is_database())
      problems.add("--quick: not with a database, for which nothing is simulated");
  }

  Option inputs = Option(this, "INPUT", "...", "One run or database, or two runs",
                         {required("a folder of run --out, two of them, or a database")}, Takes::kList);
  Option out = Option(this, "--out", "F.html", "The page to write", {ends_in(".html")});
  Option json = Option(this, "--json", "", "Print the data of the page as JSON, and write no page");
  Option quick = Option(this, "--quick", "", "Simulate nothing: no gain of the changes");
};

// What `run` has printed, and what `explain` finds, for a page without JavaScript.
std::string text_of(const runs::RecordedRun& run) {
  return run.folder + "\n\n" + stats::console_table(run.statistics, run.board);
}
std::string text_of(const runs::Explanation& found) {
  const auto line = [](const runs::Explanation::Rate& rate, const std::string& what) {
    return fmt::format("{:>10.3f} frames/s{}: {}\n", rate.frames_per_second,
                       rate.loses_pixels() ? ", losing pixels" : "", what);
  };
  std::string text = paragraph("", 0, "limited by " + runs::limiter_text(found)) +
                     paragraph("the time of a frame: ", 2, runs::budget_text(found)) +
                     line(found.now(), "this board");
  for (const auto& [step, rate, busiest] : found.steps()) {
    if (!rate.failure.empty()) continue;
    text += line(rate, fmt::format("{}{}: {} -> {}", step->knob, step->changes_disparities ? " *" : "",
                                   step->from, step->to));
  }
  if (!found.interruption().empty()) text += "interrupted: " + found.interruption() + '\n';
  return text + "*: the disparities change too\n";
}

// nullopt if interrupted.
std::optional<Json> data_of_run(const ReportOptions& options, process::Problems& problems) {
  const auto run = runs::load_recorded_run("RUN", options.inputs.texts().front(), problems);
  if (!run) return std::nullopt;
  runs::RunInput input = runs::open_again(*run, problems);
  problems.check();
  Json data = report::run_data(*run, input.tables);
  std::string text = text_of(*run);
  bool is_recorded = false;
  process::attempt_or_refuse("", [&] { is_recorded = report::add_recording(*run, input, data); });
  if (!is_recorded) {
    process::say("note", fmt::format("'{}': the run has recorded nothing: the page does not show where and "
                                     "when ports wait: run it again, without --no-record",
                                     run->folder));
  }
  if (!options.quick.is_given()) {
    runs::Explanation explanation(run->board, input.tables, input.camera);
    const bool calibrated = run->options.calibration.has_value();
    if (!explanation.simulate(calibrated ? runs::PointSimulator(input.tables) : runs::PointSimulator()))
      return std::nullopt;
    data["knobs"] = report::knobs_data(run->board, explanation);
    text += '\n' + text_of(explanation);
  }
  runs::say_lost_pixels(run->statistics, fmt::format("'{}': ", run->folder));
  return Json{{"kind", "run"}, {"text", std::move(text)}, {"run", std::move(data)}};
}

std::optional<Json> data_of_two_runs(const ReportOptions& options, process::Problems& problems) {
  const auto a = runs::load_recorded_run("A", options.inputs.texts()[0], problems);
  const auto b = runs::load_recorded_run("B", options.inputs.texts()[1], problems);
  problems.check();
  const runs::RunInput input_a = runs::open_again(*a, problems);
  const runs::RunInput input_b = runs::open_again(*b, problems);
  problems.check();
  const runs::DiffLimits limits(*a, *b);
  runs::FrameAlignment aligned(*a, *b, limits, nullptr);
  if (!aligned.run()) return std::nullopt;
  for (const runs::RecordedRun& run : {std::cref(*a), std::cref(*b)})
    runs::say_lost_pixels(run.statistics, fmt::format("'{}': ", run.folder));
  Json data = {{"kind", "two_runs"}};
  process::attempt_or_refuse("", [&] {
    data.update(report::two_runs_data({*a, input_a.tables}, {*b, input_b.tables}, aligned, limits));
  });
  data["text"] = paragraph("", 0, data["difference"]["verdict"]) + '\n' +
                 report::settings_table("board", data["difference"]["settings"]) + "\nA: " + text_of(*a) +
                 "\nB: " + text_of(*b);
  return data;
}

std::optional<Json> data_of(const ReportOptions& options, process::Problems& problems) {
  if (options.inputs.texts().size() == 2) return data_of_two_runs(options, problems);
  if (!options.is_database()) return data_of_run(options, problems);
  Json data = {{"kind", "database"}};
  problems.attempt("", [&] {
    data["database"] = report::database_data(options.inputs.texts().front());
    data["text"] = options.inputs.texts().front() + ": " + data["database"]["points"].dump() + " points";
  });
  return data;
}

int report(const ReportOptions& options) {
  process::catch_interrupts();
  process::Problems problems;
  std::optional<files::OutputFile> file;
  if (options.out.is_given())
    problems.attempt("--out ", [&] {
      file.emplace(options.out.text(),
                   files::marked_kind("page of stereotlm report", {{0, report::page_mark()}}));
    });
  std::optional<Json> data = data_of(options, problems);
  const std::string changes = data ? data->value(Json::json_pointer("/run/knobs/interrupted"), "") : "";
  if (process::interrupted() && changes.empty()) return interrupted("no page is written");
  problems.check();
  Json whole = {{"format", 2}, {"version", process::kVersion}};
  whole.update(*data);
  if (file) {
    const std::string page = report::html_page(whole);
    file->write(page);
    file->commit();
    process::print(fmt::format("{}: {} kB\n", options.out.text(), (page.size() + 999) / 1000));
  } else {
    process::print(json_text(whole));
  }
  return changes.empty() ? kDone : interrupted(changes + ", and are on the page");
}

}  // namespace

void add_report(Commands& commands) {
  add_command(commands, "report", "Write a page that shows a run, a database, or two runs compared", report,
              kReportFooter);
}

}  // namespace stereotlm::cli
