#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <stdexcept>

#include "platform/config/board_draft.h"
#include "sw/cli/command.h"
#include "sw/cli/run_options.h"
#include "sw/explore/plan/plan.h"
#include "sw/explore/plan/points.h"
#include "sw/explore/slurm/slurm.h"
#include "sw/explore/store/store.h"
#include "sw/explore/sweep/sweep.h"
#include "sw/files/text_forms.h"
#include "sw/files/whole_file.h"
#include "sw/process/client.h"
#include "sw/process/command.h"
#include "sw/runs/progress.h"
#include "sw/runs/simulation/point_quality.h"
#include "sw/runs/simulation/simulate_point.h"
#include "sw/runs/sources/calibration_input.h"

namespace stereotlm::cli {
namespace {

// "I/N" as I and N; nullopt if the text is not that, with I below N.
std::optional<std::pair<std::uint64_t, std::uint64_t>> shard_of(const std::string& text) {
  const std::size_t slash = std::min(text.find('/'), text.size());
  const auto index = number_of<std::uint64_t>(text.substr(0, slash));
  const auto count = number_of<std::uint64_t>(text.substr(std::min(slash + 1, text.size())));
  if (!index || !count || *index >= *count) return std::nullopt;
  return std::pair(*index, *count);
}

// Checks the value of one --sbatch. Reports options that the launcher itself passes to sbatch.
void check_sbatch(const std::string& option, process::Problems& problems) {
  const std::vector<std::string> own = {"array", "dependency", "error", "job-name", "output", "wait", "wrap"};
  const std::string name = option.substr(0, option.find('='));
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || c == '-'; };
  if (name.empty() || name[0] == '-' || !std::all_of(name.begin(), name.end(), is_letter)) {
    problems.add(fmt::format(
        "--sbatch = {}: must be a long option of sbatch without its dashes, such as partition=long", option));
  } else if (std::find(own.begin(), own.end(), name) != own.end()) {
    problems.add(fmt::format("--sbatch = {}: given by the launcher; others may be given", option));
  }
}

struct SweepCommandOptions : Options {
  using Options::Options;

  void check_together(process::Problems& problems) override {
    const auto refuse_given = [&problems](const Option& option, const char* rule) {
      if (option.is_given()) problems.add(fmt::format("{}: {}", option.name(), rule));
    };
    if (is_slurm()) {
      refuse_given(jobs, "not with --launcher slurm: --sbatch cpus-per-task=N");
      refuse_given(shard, "not with --launcher slurm, which submits all shards");
      refuse_given(known, "not with --launcher slurm");
      refuse_given(progress, "not with --launcher slurm");
      for (const std::string& option : sbatch.texts()) check_sbatch(option, problems);
    } else {
      refuse_given(shards, "goes with --launcher slurm");
      refuse_given(sbatch, "goes with --launcher slurm");
    }
    if (!progress.is_given()) return;
    // It is replaced, and must therefore not be another file of the user.
    problems.attempt("--progress ", [this] { progress_file(); });
  }

  explore::SweepOptions sweep() const {
    explore::SweepOptions options;
    options.store = out.text();
    options.known = known.text();
    options.jobs = jobs.number<unsigned>().value_or(options.jobs);
    std::tie(options.shard, options.shards) = shard_of(shard.text()).value_or(std::pair(0, 1));
    return options;
  }
  bool is_slurm() const { return launcher.text() == "slurm"; }
  // The file of --progress, for one write.
  files::OutputFile progress_file() const {
    const files::FileKind kind = {"file of --progress", [](const std::filesystem::path& path) {
                                    const std::string text = files::read_whole_file(path);
                                    return text == explore::counts_text(explore::read_counts(text));
                                  }};
    return files::OutputFile(progress.text(), kind,
                             {{"--out", out.text()}, {"PLAN", plan.text()}, {"--known", known.text()}});
  }

  process::FileContents sent = process::sent_files({"plan.yaml"});
  Option plan = Option(this, "PLAN", " ", "The plan's file", {required("the path of a plan")});
  Option out = Option(this, "--out", "DB", "The database to write, or to continue",
                      {required("the database to write, or to continue")});
  Option jobs = Option(this, "--jobs", "N", "Worker processes; default: the processors of this machine",
                       {is_within<unsigned>(kMostJobs)});
  Option shard = Option(this, "--shard", "I/N",
                        "Only every N-th point, from number I on (0 .. N-1); see stereotlm merge",
                        {valid("I/N with I in 0 .. N-1, such as 0/4",
                               [](const std::string& text) { return shard_of(text).has_value(); })});
  Option board = Option(this, "--board", "BOARD", "In place of the board that the plan names");
  Option calibration = Option(this, "--calibration", "F", "In place of the calibration that the plan names");
  Option known = Option(this, "--known", "DB2", "A database, only read, whose points are not run either");
  Option progress = Option(this, "--progress", "F", "Keep in this file how many points are done");
  Option launcher = Option(this, "--launcher", "WHERE", "Where it runs: local, the default, or slurm",
                           {one_of({"local", "slurm"})});
  Option shards = Option(this, "--shards", "N", "With slurm: the tasks of the job array (default 16)",
                         {is_within<std::uint64_t>(kMostShards)});
  Option sbatch = Option(this, "--sbatch", "NAME=VALUE",
                         "With slurm: an option of sbatch for all jobs, such as partition=long or "
                         "time=8:00:00; again for further ones",
                         {}, Takes::kRepeated);

 private:
  static constexpr std::uint64_t kMostJobs = 1024;
  static constexpr std::uint64_t kMostShards = 1000;

  template <typename Number>
  static Rule is_within(std::uint64_t most) {
    return number<Number>("1.." + std::to_string(most),
                          [most](Number count) { return count >= 1 && count <= most; });
  }
};

struct MergeOptions : Options {
  using Options::Options;

  Option out = Option(this, "OUT", " ", "The database to write", {required("the database to write")});
  Option inputs = Option(this, "DB", "...", "Databases of sweep, such as those of its shards",
                         {required("the databases to merge")}, Takes::kList);
};

int merge(const MergeOptions& options) {
  try {
    const explore::StoreLock lock(options.out.text());
    process::catch_interrupts();
    runs::ProgressLine progress(fmt::format("{} databases are merged", options.inputs.texts().size()));
    explore::merge_stores(options.inputs.texts(), options.out.text(), [&progress] {
      progress.show_time();
      return process::interrupted();
    });
  } catch (const sqlite::DatabaseError& error) {
    if (process::interrupted()) return interrupted("nothing is written");
    process::refuse(error.what());
  }
  sqlite::Database merged(options.out.text(), sqlite::Database::Access::kRead);
  const std::size_t inputs = options.inputs.texts().size();
  process::print(fmt::format("{}: {} points of {} database{}\n", options.out.text(),
                             merged.number("SELECT count(*) FROM points"), inputs, inputs == 1 ? "" : "s"));
  return kDone;
}

constexpr std::chrono::seconds kBetweenCounts{2};
// Timeout for a locked database, if the database is only opened to check that it can be read.
constexpr std::chrono::seconds kBriefTimeout{5};

constexpr const char* kSweepFooter =
    "A plan is a YAML file, such as\n"
    "  board: fpl2003                                       # a preset or a board file\n"
    "  run: {source: preloaded}                             # how each point runs, see below\n"
    "  set: {matcher.filter: none}                          # keys of all points\n"
    "  vary:                                                # all combinations of these\n"
    "    matcher.window: [5, 7, 9]\n"
    "    matcher.disparities: {from: 16, to: 128, step: 16}\n"
    "  zip:                                                 # with these, whose keys move together\n"
    "    - {image.width: [320, 640], image.height: [240, 480]}\n"
    "  where: [matcher.window * matcher.disparities <= 800] # SQL over keys: leaves the others out\n"
    "  sample: {points: 20, seed: 1}                        # so many of them, drawn before `where`\n"
    "(see stereotlm keys). What may stand in `run`:\n"
    "  source       preloaded, the core alone, fed by an ideal host (the default of a plan), or camera,\n"
    "               the whole computer (the default of run, explain, conflicts and allocate)\n"
    "  frames       to deliver: by default one turn of the allocation's lists, with cameras 12 more\n"
    "  calibration  F.yaml of stereotlm calibrate: the tables; by default they are the identity\n"
    "  pairs        [{left: F, right: F, truth: F, scale: 4}, ..]: accuracy.* over all these pictures\n"
    "  synthetic    [1, 2, ..]: accuracy.* over the first frames of the made scenes of these seeds\n\n"
    "Each point is a row of table `points` of DB, an SQLite database: its status, the reason if it is not\n"
    "ok, the board in full, and a column for each key and for each figure (keys --figures). View `plain` is\n"
    "the same with names that need no quotes. Waits by port, bank and cause are in table `blame`. Such as\n"
    "  sqlite3 -box DB 'SELECT name, unit, meaning FROM columns WHERE varied'\n"
    "  sqlite3 -box DB 'SELECT matcher_window, frames_per_second_core FROM plain ORDER BY 1'\n"
    "Points that DB holds already are not run again: after an interruption, give the same command. To try\n"
    "again what has failed:\n"
    "  sqlite3 DB \"DELETE FROM points WHERE status = 'failed'\"\n\n"
    "--launcher slurm submits a job array, a shard a task, and a last job that merges the shards into\n"
    "DB; it waits, and submits lost shards again. The machines share the file system of DB and of this\n"
    "program. A task uses the processors that its job has: --sbatch cpus-per-task=8.";

std::string summary(const explore::SweepCounts& counts, const SweepCommandOptions& options) {
  std::string text = fmt::format("{}: {} points", options.plan.text(), counts.total);
  if (options.shard.is_given()) text += fmt::format(" in shard {}", options.shard.text());
  text += fmt::format(": {} ok, {} impossible, {} failed", counts.ok, counts.impossible, counts.failed);
  if (counts.known > 0) text += fmt::format(", {} there already", counts.known);
  if (counts.excluded > 0) text += fmt::format(", {} left out by where", counts.excluded);
  if (counts.done() < counts.total) text += fmt::format(", {} not begun", counts.total - counts.done());
  return text + '\n';
}

// A line for each reason with its number of points: of failed points first, then of impossible ones (ORDER BY
// status: 'failed' < 'impossible'), the most frequent first. If a status has over four reasons, a line counts
// those after the third, and the last line says how to list all. One scan of the table.
std::string reasons(sqlite::Database& store) {
  sqlite::Statement statement(
      store,
      "SELECT status, reason, sum(points), count(*) FROM ("
      "  SELECT status, reason, count(*) AS points,"
      "    min(4, row_number() OVER (PARTITION BY status ORDER BY count(*) DESC, reason)) AS place"
      "  FROM points WHERE status <> 'ok' GROUP BY status, reason)"
      " GROUP BY status, place ORDER BY status, place");
  std::string text;
  bool has_further = false;
  while (statement.step()) {
    const bool is_further = statement.integer(3) > 1;
    has_further = has_further || is_further;
    text += fmt::format("  {} {}: {}\n", statement.text(2), statement.text(0),
                        is_further ? statement.text(3) + " further reasons" : statement.text(1));
  }
  if (has_further) {
    text += fmt::format(
        "All reasons:\n  sqlite3 {} \"SELECT count(*), status, reason FROM points WHERE status <> 'ok' "
        "GROUP BY status, reason\"\n",
        files::shell_word(store.path()));
  }
  return text;
}

int report(const explore::SweepCounts& counts, const SweepCommandOptions& options) {
  std::string text = summary(counts, options);
  if (std::filesystem::exists(options.out.text())) {
    sqlite::Database store(options.out.text(), sqlite::Database::Access::kRead);
    text += fmt::format("{}: {} points\n", options.out.text(), store.number("SELECT count(*) FROM points"));
    text += reasons(store);
  }
  process::print(text);
  return counts.done() == counts.total ? kDone : interrupted("run the same command to resume");
}

// The end of an error message: that finished points are kept. Empty if the database cannot be read.
std::string kept_text(const std::string& store, const std::string& advice) {
  try {
    sqlite::Database(store, sqlite::Database::Access::kRead, kBriefTimeout)
        .number("SELECT count(*) FROM points");
    return "; finished points are kept: " + advice;
  } catch (const sqlite::DatabaseError&) {
    return "";
  }
}

void write_progress(const explore::SweepCounts& counts, const SweepCommandOptions& options) {
  if (!options.progress.is_given()) return;
  files::OutputFile file = options.progress_file();
  file.write(explore::counts_text(counts));
  file.commit();
}

void prepare(const SweepCommandOptions& options, const explore::SweepOptions& sweep,
             const explore::Plan& plan) {
  check_jobs(sweep.jobs, std::min<std::uint64_t>(sweep.jobs, plan.size()));
  process::attempt_or_refuse("--known ", [&] {
    if (!options.known.is_given()) return;
    files::check_is_another(sweep.known, {{"--out", sweep.store}});
    const explore::StoredRow known(sweep.known, sweep.version);
  });
  try {
    const explore::StoreLock lock(sweep.store);
    const auto open_store = [&] { explore::Store(sweep.store, sweep.version).check_banks(plan.banks()); };
    if (std::filesystem::file_size(sweep.store) > 0) open_store();
    process::catch_interrupts();
    process::attempt_or_refuse("--progress ", [&] { write_progress({}, options); });
    open_store();  // creates a new store only after all other checks
  } catch (const sqlite::DatabaseError& error) {
    process::refuse(fmt::format("--out {}", error.what()));
  }
}

explore::SweepCounts sweep_here(const SweepCommandOptions& options, const explore::Plan& plan,
                                const std::optional<runs::CalibrationInput>& calibration,
                                runs::PointQuality quality) {
  const explore::SweepOptions sweep = options.sweep();
  prepare(options, sweep, plan);
  runs::PointSimulator simulator =
      calibration ? runs::PointSimulator(calibration->tables) : runs::PointSimulator();
  simulator.judge(std::move(quality));
  runs::ProgressLine progress(fmt::format("{} points are simulated, or left out", plan.size()));
  auto next_write = std::chrono::steady_clock::now() + kBetweenCounts;
  const auto show = [&](const explore::SweepCounts& done) {
    progress.show(done.done(), done.total, [&done](double seconds) {
      return runs::progress_text(done.done(), done.total, "points", seconds);
    });
    if (std::chrono::steady_clock::now() >= next_write) {
      write_progress(done, options);
      next_write = std::chrono::steady_clock::now() + kBetweenCounts;
    }
    return !process::interrupted();
  };
  try {
    const explore::SweepCounts counts = explore::sweep(
        plan.points(), [&simulator](const explore::Point& point) { return simulator(point); }, sweep, show);
    write_progress(counts, options);
    return counts;
  } catch (const explore::StoreGone&) {
    throw;
  } catch (const std::exception& error) {
    const bool is_of_plan = dynamic_cast<const explore::ConditionError*>(&error) != nullptr;
    throw std::runtime_error(
        process::text_of(error) +
        kept_text(options.out.text(), is_of_plan ? "correct the plan" : "run the same command to resume"));
  }
}

explore::ShardedSweep sharded(const SweepCommandOptions& options, const explore::Plan& plan,
                              const std::optional<runs::CalibrationInput>& calibration) {
  explore::ShardedSweep sweep;
  if (calibration) sweep.files = calibration->contents;
  sweep.files["plan.yaml"] = plan.text();
  if (!plan.board_text().empty()) sweep.files["board.yaml"] = plan.board_text();
  sweep.banks = plan.banks();
  sweep.version = process::kVersion;
  sweep.points = plan.size();
  constexpr std::uint64_t kDefaultShards = 16;
  sweep.shards = std::min(options.shards.number<std::uint64_t>().value_or(kDefaultShards), plan.size());
  return sweep;
}

std::string line_of(const explore::SlurmProgress& progress, std::uint64_t before, double seconds) {
  const explore::SweepCounts& counts = progress.counts;
  std::string text = runs::progress_text(counts.done(), counts.total, "points", seconds, before);
  text += fmt::format(", {} running", progress.running);
  if (progress.waiting > 0) text += fmt::format(", {} waiting", progress.waiting);
  if (!progress.reason.empty()) text += fmt::format(" ({})", progress.reason);
  return text;
}

// Submits a sweep as jobs of Slurm, shows their progress, waits until they have ended, and returns the counts
// of the sweep. If interrupted, cancels the jobs and returns early. Throws Refused if the jobs cannot be
// submitted, and std::runtime_error if the sweep fails later.
explore::SweepCounts sweep_on_slurm(const SweepCommandOptions& options, const explore::Plan& plan,
                                    const std::optional<runs::CalibrationInput>& calibration) {
  runs::ProgressLine progress(fmt::format("{} points are simulated, or left out", plan.size()));
  const auto say_note = [&progress](const std::string& note) {
    progress.erase();
    process::say("note", note);
  };
  explore::SlurmSweep sweep(sharded(options, plan, calibration), options.sbatch.texts(), say_note);
  process::catch_interrupts();
  try {
    sweep.begin(options.out.text());
  } catch (const sqlite::DatabaseError& error) {
    process::refuse(fmt::format("--out {}", error.what()));
  } catch (const std::exception& error) {
    process::refuse(fmt::format("--launcher slurm: {}", process::text_of(error)));
  }
  std::optional<std::uint64_t> before;
  return sweep.wait([&](const explore::SlurmProgress& now) {
    if (!before) before = now.counts.done();
    progress.show(now.counts.done(), now.counts.total,
                  [&](double seconds) { return line_of(now, *before, seconds); });
    return !process::interrupted();
  });
}

int sweep(const SweepCommandOptions& options) {
  std::optional<explore::Plan> loaded;
  process::attempt_or_refuse("", [&] {
    const std::string& plan = options.plan.text();
    const std::string& board = options.board.text();
    loaded = explore::Plan::load(plan, board, sent_content(options.sent, "plan.yaml", plan),
                                 sent_content(options.sent, "board.yaml", board));
  });
  explore::Plan& plan = *loaded;
  if (!plan.wishes_place().empty())
    process::refuse(plan.wishes_place() + ": of a search: stereotlm optimise takes this plan");
  const auto calibration = calibration_of(plan, options.calibration, options.sent);
  process::Problems problems;
  if (options.is_slurm() && !plan.pairs().empty()) {
    problems.add(
        fmt::format("{}: {}: not with --launcher slurm: its tasks work on copies of all files, and "
                    "pictures are not copied; use --shard I/N and merge, or made scenes ({})",
                    plan.pairs().front().place, explore::kPairsPath, explore::kSyntheticPath));
  }
  runs::PointQuality quality(plan, problems);
  problems.check();
  const explore::SweepCounts counts = options.is_slurm()
                                          ? sweep_on_slurm(options, plan, calibration)
                                          : sweep_here(options, plan, calibration, std::move(quality));
  return report(counts, options);
}

}  // namespace

void add_merge(Commands& commands) {
  add_command(
      commands, "merge", "Put the points of several databases of sweep into one", merge,
      "The bytes of OUT depend on nothing but the points: neither on the number of databases nor on their\n"
      "order. OUT may be one of them. Databases that hold different results of one point are an error.");
}

void add_sweep(Commands& commands) {
  add_command(commands, "sweep", "Simulate all points of a plan, and keep their figures", sweep,
              kSweepFooter);
}

}  // namespace stereotlm::cli
