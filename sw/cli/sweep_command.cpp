#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "sw/cli/add_command.h"
#include "sw/cli/commands.h"
#include "sw/cli/exit_status.h"
#include "sw/cli/interrupt.h"
#include "sw/cli/progress.h"
#include "sw/cli/streams.h"
#include "sw/cli/typed_option.h"
#include "sw/cli/unbuilt.h"
#include "sw/cli/version.h"
#include "sw/explore/plan.h"
#include "sw/explore/store.h"
#include "sw/explore/sweep.h"
#include "sw/simulation/simulate_point.h"

namespace stereotlm::cli {
namespace {

constexpr unsigned kMostJobs = 1024;

constexpr const char* kFooter =
    "A plan is a YAML file, such as\n"
    "  board: fpl2003                                       # a preset or a board file; its tables\n"
    "  run: {source: preloaded}                             # are the identity. Or camera; and frames\n"
    "  set: {matcher.filter: none}                          # of every point\n"
    "  vary:                                                # all combinations of these\n"
    "    matcher.window: [5, 7, 9]\n"
    "    matcher.disparities: {from: 16, to: 128, step: 16}\n"
    "  zip:                                                 # with these, whose keys move together\n"
    "    - {image.width: [320, 640], image.height: [240, 480]}\n"
    "  where: [matcher.window * matcher.disparities <= 800] # SQL over keys: leaves the others out\n"
    "  sample: {points: 20, seed: 1}                        # so many of them, drawn before `where`\n"
    "(see stereotlm keys). Each point is a row of table `points` of DB, an SQLite database: its status,\n"
    "the reason if it is not ok, the board in full, and a column for each key and for each figure of\n"
    "stats.json; stalls by port, bank and cause are in table `blame`. For instance\n"
    "  sqlite3 -box DB 'SELECT \"matcher.window\", \"frames_per_second.core\" FROM points'\n"
    "Points that DB holds already are not run again: after an interruption, give the same command.";

struct SweepCommandOptions {
  Typed plan;
  Typed out;
  Typed jobs;
  Typed shard;
  Typed launcher;

  void add_to(CLI::App& command) {
    plan.add_to(command, "PLAN", " ", "The plan's file");
    out.add_to(command, "--out", "DB", "The database to write, or to continue");
    jobs.add_to(command, "--jobs", "N", "Worker processes; default: the processors of this machine");
    shard.add_to(command, "--shard", "I/N",
                 "Only every N-th point, from number I on (0 .. N-1); see stereotlm merge");
    launcher.add_to(command, "--launcher", "WHERE", "Where it runs: local, the default");
  }

  // As check_usage() leaves them.
  explore::SweepOptions sweep;

  void check_usage() {
    Problems problems;
    if (!plan.is_given()) problems.add("PLAN: missing: the path of a plan");
    if (!out.is_given()) problems.add("--out: missing: the database to write, or to continue");
    sweep.store = out.text;
    sweep.version = kVersion;
    sweep.jobs = std::max(1U, std::thread::hardware_concurrency());
    if (jobs.is_given()) {
      const auto number = number_of<unsigned>(jobs.text);
      if (!number || *number < 1 || *number > kMostJobs) {
        problems.add(fmt::format("--jobs = {}: must be 1..{}", jobs.text, kMostJobs));
      } else {
        sweep.jobs = *number;
      }
    }
    if (shard.is_given()) check_shard(problems);
    if (launcher.is_given() && is_one_of({"local", "slurm"}, "--launcher", launcher.text, problems) &&
        launcher.text == "slurm") {
      problems.add(fmt::format("--launcher slurm: {}; built: local", kNotInThisVersion));
    }
    problems.check();
  }

 private:
  void check_shard(Problems& problems) {
    const std::size_t slash = shard.text.find('/');
    const auto index = number_of<std::uint64_t>(shard.text.substr(0, slash));
    const auto count = slash == std::string::npos
                           ? std::nullopt
                           : number_of<std::uint64_t>(std::string_view(shard.text).substr(slash + 1));
    if (!index || !count || *index >= *count) {
      problems.add(fmt::format("--shard = {}: must be I/N with I in 0 .. N-1, such as 0/4", shard.text));
      return;
    }
    sweep.shard = *index;
    sweep.shards = *count;
  }
};

std::string progress_text(const explore::SweepCounts& counts, double seconds) {
  const auto done = static_cast<double>(counts.done());
  const double rate = done / seconds;
  return fmt::format("{}/{} points   {:.1f} %   {:.1f} points/s   {} left", counts.done(), counts.total,
                     100 * done / static_cast<double>(counts.total), rate,
                     time_text((static_cast<double>(counts.total) - done) / rate));
}

explore::Plan load_plan(const std::string& path) {
  try {
    return explore::Plan::load(path);
  } catch (const platform::BoardError& error) {
    Problems problems;
    problems.add(error);
    problems.check();
    throw;
  }
}

std::string summary(const explore::SweepCounts& counts, const SweepCommandOptions& options) {
  std::string text = fmt::format("{}: {} points", options.plan.text, counts.total);
  if (options.sweep.shards > 1) text += fmt::format(" in shard {}", options.shard.text);
  text += fmt::format(": {} ok, {} impossible, {} failed", counts.ok, counts.impossible, counts.failed);
  if (counts.known > 0) text += fmt::format(", {} there already", counts.known);
  if (counts.excluded > 0) text += fmt::format(", {} left out by where", counts.excluded);
  if (counts.done() < counts.total) text += fmt::format(", {} not begun", counts.total - counts.done());
  return text + '\n';
}

// The first points of that status, with their reasons.
std::string reasons(explore::Database& store, const std::string& status) {
  constexpr int kMost = 3;
  std::string text;
  explore::Statement statement(
      store,
      "SELECT reason, count(*) FROM points WHERE status = ? GROUP BY reason ORDER BY 2 DESC, 1 LIMIT ?");
  statement.bind(1, status);
  statement.bind(2, std::int64_t{kMost});
  while (statement.step()) {
    text += fmt::format("  {} {}: {}\n", statement.text(1), status, statement.text(0));
  }
  return text;
}

int sweep(const SweepCommandOptions& options) {
  const explore::Plan plan = load_plan(options.plan.text);
  try {
    const explore::Store store(options.sweep.store, options.sweep.version);
  } catch (const explore::DatabaseError& error) {
    refuse(fmt::format("--out {}", error.what()));
  }
  catch_interrupts();
  simulation::PointSimulator simulator;
  ProgressLine progress;
  const auto counts = explore::sweep(
      plan, [&simulator](const explore::Point& point) { return simulator(point); }, options.sweep,
      [&progress](const explore::SweepCounts& done) {
        progress.show([&done](double seconds) { return progress_text(done, seconds); });
        return !interrupted();
      });
  progress.erase();
  explore::Database store(options.sweep.store, explore::Database::Access::kRead);
  std::string text = summary(counts, options) + reasons(store, "failed") + reasons(store, "impossible");
  text += fmt::format("{}: {} points\n", options.sweep.store, store.number("SELECT count(*) FROM points"));
  print(text);
  if (counts.done() == counts.total) return kDone;
  say("note", "interrupted: the same command goes on where this one has ended");
  return kInterrupted;
}

}  // namespace

void add_sweep(CLI::App& program, Action& action) {
  const auto options = std::make_shared<SweepCommandOptions>();
  const auto parsed = [options, &action] {
    options->check_usage();
    action = [options] { return sweep(*options); };
  };
  options->add_to(add_command(program, "sweep", "Simulate all points of a plan, and keep their figures",
                              parsed, kFooter));
}

}  // namespace stereotlm::cli
