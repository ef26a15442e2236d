#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <system_error>

#include "calib/calibration.h"
#include "platform/config/board_draft.h"
#include "sw/cli/command.h"
#include "sw/cli/sweep_options.h"
#include "sw/explore/plan/conditions.h"
#include "sw/explore/plan/plan.h"
#include "sw/explore/slurm/shard_folder.h"
#include "sw/explore/slurm/slurm_sweep.h"
#include "sw/explore/store/store.h"
#include "sw/explore/store/store_lock.h"
#include "sw/explore/sweep/sweep.h"
#include "sw/files/output_file.h"
#include "sw/files/shell_word.h"
#include "sw/files/whole_file.h"
#include "sw/process/installation.h"
#include "sw/process/interrupt.h"
#include "sw/process/streams.h"
#include "sw/runs/progress.h"
#include "sw/runs/simulation/simulate_point.h"
#include "sw/runs/sources/calibration_input.h"

namespace stereotlm::cli {
namespace {

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
    "  calibration  F.yaml of stereotlm calibrate: the tables; by default they are the identity\n\n"
    "Each point is a row of table `points` of DB, an SQLite database: its status, the reason if it is not\n"
    "ok, the board in full, and a column for each key and for each figure of stats.json; waits by port,\n"
    "bank and cause are in table `blame`. For instance\n"
    "  sqlite3 DB \"SELECT name FROM pragma_table_info('points')\"      # all columns\n"
    "  sqlite3 -box DB 'SELECT \"matcher.window\", \"frames_per_second.core\" FROM points ORDER BY 1'\n"
    "Points that DB holds already are not run again: after an interruption, give the same command. To try\n"
    "again what has failed:\n"
    "  sqlite3 DB \"DELETE FROM points WHERE status = 'failed'\"\n\n"
    "--launcher slurm submits a job array, a shard a task, and a last job that merges the shards into\n"
    "DB; it waits, and submits lost shards again. The machines share the file system of DB and of this\n"
    "program. A task uses the processors that its job has: --sbatch cpus-per-task=8.";

explore::Plan load_plan(const SweepCommandOptions& options) {
  try {
    return explore::Plan::load(options.plan.text(), options.board.text());
  } catch (const platform::BoardError& error) {
    process::Problems problems;
    problems.add(error);
    problems.check();
    throw;
  }
}

// Loads the calibration that --calibration or the plan names, and gives its tables to the plan. Returns
// nullopt if neither names one. Throws Refused if the calibration cannot be loaded or fits no point.
std::optional<runs::CalibrationInput> calibration_of(const SweepCommandOptions& options,
                                                     explore::Plan& plan) {
  const bool is_option = !options.calibration.text().empty();
  const std::string path = is_option ? options.calibration.text() : plan.calibration();
  if (path.empty()) return std::nullopt;
  const std::string named = is_option
                                ? "--calibration"
                                : fmt::format("{}: {}", plan.calibration_place(), explore::kCalibrationPath);
  process::Problems problems;
  auto calibration = runs::load_calibration(path, nullptr, problems, named);
  if (calibration) {
    const calib::Rig& rig = calibration->calibration->rig;
    const auto problem = plan.use_calibration(runs::sha256_of(calibration->tables), rig.width, rig.height,
                                              platform::joint_tables_problem(calibration->tables));
    if (problem) problems.add(fmt::format("{} '{}': {}", named, path, *problem));
  }
  problems.check();
  return calibration;
}

std::string summary(const explore::SweepCounts& counts, const SweepCommandOptions& options) {
  std::string text = fmt::format("{}: {} points", options.plan.text(), counts.total);
  if (options.shard.is_given()) text += fmt::format(" in shard {}", options.shard.text());
  text += fmt::format(": {} ok, {} impossible, {} failed", counts.ok, counts.impossible, counts.failed);
  if (counts.known > 0) text += fmt::format(", {} there already", counts.known);
  if (counts.excluded > 0) text += fmt::format(", {} left out by where", counts.excluded);
  if (counts.done() < counts.total) text += fmt::format(", {} not begun", counts.total - counts.done());
  return text + '\n';
}

// The lines with the reasons of points that failed, then of impossible ones, and the number of points for
// each reason, the most frequent first. Of more than four reasons, a line counts those after the third, and
// the last line says how to list all. One scan of the table; by name 'failed' comes before 'impossible'.
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

// The end of an error message, which states that finished points are kept. Empty if the database cannot be
// read.
std::string kept_text(const std::string& store, const std::string& advice) {
  try {
    sqlite::Database(store, sqlite::Database::Access::kRead, kBriefTimeout)
        .number("SELECT count(*) FROM points");
    return "; finished points are kept: " + advice;
  } catch (const sqlite::DatabaseError&) {
    return "";
  }
}

// Writes the counts of the sweep to the file of --progress: show() at most once in kBetweenCounts, write()
// always. Does nothing without --progress.
class ProgressFile {
 public:
  explicit ProgressFile(const SweepCommandOptions& options) : options_(options) {}
  void show(const explore::SweepCounts& counts) {
    const auto now = std::chrono::steady_clock::now();
    if (now >= next_) write(counts);
  }
  void write(const explore::SweepCounts& counts) {
    if (options_.progress.text().empty()) return;
    files::OutputFile file = options_.progress_file();
    file.write(explore::counts_text(counts));
    file.commit();
    next_ = std::chrono::steady_clock::now() + kBetweenCounts;
  }

 private:
  const SweepCommandOptions& options_;
  std::chrono::steady_clock::time_point next_;
};

void check_open_files(std::uint64_t jobs, std::uint64_t points) {
  const std::uint64_t workers = std::min(jobs, points);
  const std::uint64_t most = explore::workers_with_files(workers);
  if (most == workers) return;
  const std::string rule =
      fmt::format("--jobs = {}: too many for the limit on open files (ulimit -n): ", jobs);
  process::refuse(rule +
                  (most == 0 ? "raise it" : fmt::format("lower --jobs to {}, or raise the limit", most)));
}

explore::SweepCounts sweep_here(const SweepCommandOptions& options, const explore::Plan& plan,
                                const std::optional<runs::CalibrationInput>& calibration) {
  const explore::SweepOptions sweep = options.sweep();
  check_open_files(sweep.jobs, plan.size());
  ProgressFile file(options);
  try {
    if (options.known.is_given()) const explore::StoredRow known(sweep.known, sweep.version);
  } catch (const sqlite::DatabaseError& error) {
    process::refuse(fmt::format("--known {}", error.what()));
  }
  try {
    const explore::StoreLock lock(options.out.text());
    const auto open_store = [&] {
      explore::Store(options.out.text(), sweep.version).check_banks(plan.banks());
    };
    if (std::filesystem::file_size(options.out.text()) > 0) open_store();
    process::catch_interrupts();
    file.write({});
    open_store();  // creates a new store only after all other checks
  } catch (const sqlite::DatabaseError& error) {
    process::refuse(fmt::format("--out {}", error.what()));
  } catch (const std::runtime_error& error) {
    process::refuse(fmt::format("--progress {}", error.what()));
  }
  runs::PointSimulator simulator =
      calibration ? runs::PointSimulator(calibration->tables) : runs::PointSimulator();
  runs::ProgressLine progress;
  explore::SweepCounts counts;
  try {
    counts = explore::sweep(
        plan.points(), [&simulator](const explore::Point& point) { return simulator(point); }, sweep,
        [&progress, &file](const explore::SweepCounts& done) {
          progress.show([&done](double seconds) { return runs::progress_text(done, 0, seconds); });
          file.show(done);
          return !process::interrupted();
        });
    progress.erase();
    file.write(counts);
  } catch (const explore::StoreGone&) {
    progress.erase();
    throw;
  } catch (const explore::ConditionError& error) {
    progress.erase();
    throw std::runtime_error(error.what() + kept_text(options.out.text(), "correct the plan"));
  } catch (const std::exception& error) {
    progress.erase();
    throw std::runtime_error(error.what() + kept_text(options.out.text(), "run the same command to resume"));
  }
  return counts;
}

// The sweep for Slurm, with the contents of all files that its tasks need.
explore::ShardedSweep sharded(const SweepCommandOptions& options, const explore::Plan& plan,
                              const std::optional<runs::CalibrationInput>& calibration) {
  explore::ShardedSweep sweep;
  sweep.plan = files::read_whole_file(plan.path());
  if (platform::is_board_file(plan.board())) sweep.board = files::read_whole_file(plan.board());
  if (calibration) {
    const runs::InputCalibration& files = calibration->described;
    sweep.calibration = {files::read_whole_file(files.file.path), files::read_whole_file(files.left_lut.path),
                         files::read_whole_file(files.right_lut.path)};
  }
  sweep.banks = plan.banks();
  sweep.version = process::kVersion;
  sweep.points = plan.size();
  sweep.shards = std::min(options.tasks(), plan.size());
  return sweep;
}

std::string line_of(const explore::SlurmProgress& progress, std::uint64_t before, double seconds) {
  std::string text = runs::progress_text(progress.counts, before, seconds);
  text += fmt::format("   {} running", progress.running);
  if (progress.waiting > 0) text += fmt::format(", {} waiting", progress.waiting);
  if (!progress.reason.empty()) text += fmt::format(" ({})", progress.reason);
  return text;
}

// Submits a sweep as jobs of Slurm, shows their progress, waits until they have ended, and returns the counts
// of the sweep. If interrupted, cancels the jobs and returns early. Throws Refused if the jobs cannot be
// submitted, and std::runtime_error if the sweep fails later.
explore::SweepCounts sweep_on_slurm(const SweepCommandOptions& options, const explore::Plan& plan,
                                    const std::optional<runs::CalibrationInput>& calibration) {
  runs::ProgressLine progress;
  const auto say_note = [&progress](const std::string& note) {
    progress.erase();
    process::say("note", note);
  };
  const auto opened = [&] {
    try {
      return explore::SlurmSweep(sharded(options, plan, calibration), options.out.text(),
                                 options.sbatch_options(), say_note);
    } catch (const sqlite::DatabaseError& error) {
      process::refuse(fmt::format("--out {}", error.what()));
    } catch (const std::system_error& error) {
      process::refuse(fmt::format("--out {}: {}", options.out.text(), error.code().message()));
    }
  };
  explore::SlurmSweep sweep = opened();
  process::catch_interrupts();
  try {
    sweep.begin();
  } catch (const sqlite::DatabaseError& error) {
    process::refuse(fmt::format("--out {}", error.what()));
  } catch (const std::exception& error) {
    process::refuse(fmt::format("--launcher slurm: {}", error.what()));
  }
  std::optional<std::uint64_t> before;
  const auto counts = sweep.wait([&](const explore::SlurmProgress& now) {
    if (!before) before = now.counts.done();
    progress.show([&](double seconds) { return line_of(now, *before, seconds); });
    return !process::interrupted();
  });
  progress.erase();
  return counts;
}

int sweep(const SweepCommandOptions& options) {
  explore::Plan plan = load_plan(options);
  const auto calibration = calibration_of(options, plan);
  const explore::SweepCounts counts = options.is_slurm() ? sweep_on_slurm(options, plan, calibration)
                                                         : sweep_here(options, plan, calibration);
  return report(counts, options);
}

}  // namespace

void add_sweep(CLI::App& program, Action& action) {
  add_command(program, action, "sweep", "Simulate all points of a plan, and keep their figures", sweep,
              kSweepFooter);
}

}  // namespace stereotlm::cli
