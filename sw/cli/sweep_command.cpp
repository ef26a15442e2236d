#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "calib/calibration.h"
#include "platform/config/board_draft.h"
#include "sw/cli/add_command.h"
#include "sw/cli/commands.h"
#include "sw/cli/exit_status.h"
#include "sw/cli/typed_option.h"
#include "sw/explore/plan/conditions.h"
#include "sw/explore/plan/plan.h"
#include "sw/explore/slurm/shard_folder.h"
#include "sw/explore/slurm/slurm_sweep.h"
#include "sw/explore/store/store.h"
#include "sw/explore/store/store_lock.h"
#include "sw/explore/sweep/sweep.h"
#include "sw/files/replaced_file.h"
#include "sw/files/whole_file.h"
#include "sw/process/interrupt.h"
#include "sw/process/streams.h"
#include "sw/process/version.h"
#include "sw/runs/progress.h"
#include "sw/runs/simulation/simulate_point.h"
#include "sw/runs/sources/calibration_input.h"

namespace stereotlm::cli {
namespace {

constexpr unsigned kMostJobs = 1024;
constexpr std::uint64_t kMostShards = 1000;  // of a job array: merge opens all their files
constexpr std::uint64_t kDefaultShards = 16;
constexpr std::chrono::seconds kBetweenCounts{2};
constexpr std::chrono::seconds kBriefPatience{
    5};  // with who keeps a database locked that is looked at once more

constexpr const char* kFooter =
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
    "  source       preloaded, the core alone, fed by an ideal host (the default here), or camera, the\n"
    "               whole computer\n"
    "  frames       to deliver: by default one turn of the allocation's lists, with cameras 13\n"
    "  calibration  F.yaml of stereotlm calibrate: the tables; by default they are the identity\n\n"
    "Each point is a row of table `points` of DB, an SQLite database: its status, the reason if it is not\n"
    "ok, the board in full, and a column for each key and for each figure of stats.json; stalls by port,\n"
    "bank and cause are in table `blame`. For instance\n"
    "  sqlite3 DB \"SELECT name FROM pragma_table_info('points')\"      # all columns\n"
    "  sqlite3 -box DB 'SELECT \"matcher.window\", \"frames_per_second.core\" FROM points ORDER BY 1'\n"
    "Points that DB holds already are not run again: after an interruption, give the same command. To try\n"
    "again what has failed:\n"
    "  sqlite3 DB \"DELETE FROM points WHERE status = 'failed'\"\n\n"
    "--launcher slurm submits a job array, a shard a task, and a last job that merges the shards into\n"
    "DB; it waits, and submits again what is lost. The machines share the file system of DB and of this\n"
    "program. A task uses the processors that its job has: --sbatch cpus-per-task=8.";

// Also of files that are not there yet.
bool is_same_file(const std::string& a, const std::string& b) {
  std::error_code none;
  if (std::filesystem::equivalent(a, b, none)) return true;
  const auto whole = [&none](const std::string& path) {
    return std::filesystem::weakly_canonical(std::filesystem::absolute(path), none);
  };
  return whole(a) == whole(b);
}

// Whether it is one of --progress, or empty.
bool is_counts_file(const std::string& path) {
  try {
    const std::string text = files::read_whole_file(path);
    return text.empty() || text == explore::counts_text(explore::read_counts(text));
  } catch (const std::runtime_error&) {
    return false;
  }
}

struct SweepCommandOptions {
  Typed plan;
  Typed out;
  Typed jobs;
  Typed shard;
  Typed board;
  Typed calibration;
  Typed known;
  Typed progress;
  Typed launcher;
  Typed shards_option;
  TypedList sbatch;

  void add_to(CLI::App& command) {
    plan.add_to(command, "PLAN", " ", "The plan's file");
    out.add_to(command, "--out", "DB", "The database to write, or to continue");
    jobs.add_to(command, "--jobs", "N", "Worker processes; default: the processors of this machine");
    shard.add_to(command, "--shard", "I/N",
                 "Only every N-th point, from number I on (0 .. N-1); see stereotlm merge");
    board.add_to(command, "--board", "BOARD", "In place of the board that the plan names");
    calibration.add_to(command, "--calibration", "F", "In place of the calibration that the plan names");
    known.add_to(command, "--known", "DB2", "A database, only read, whose points are not run either");
    progress.add_to(command, "--progress", "F", "Keep in this file how many points are done");
    launcher.add_to(command, "--launcher", "WHERE", "Where it runs: local, the default, or slurm");
    shards_option.add_to(command, "--shards", "N",
                         fmt::format("With slurm: the tasks of the job array (default {})", kDefaultShards));
    sbatch.add_to(
        command, "--sbatch", "NAME=VALUE",
        "With slurm: an option of sbatch for all jobs, such as partition=long or time=8:00:00; again "
        "for further ones");
    sbatch.takes_one_at_a_time();
  }

  // As check_usage() leaves them.
  explore::SweepOptions sweep;
  bool is_slurm = false;
  std::uint64_t shards = kDefaultShards;
  std::vector<std::string> sbatch_options;

  void check_usage() {
    process::Problems problems;
    if (!plan.is_given()) problems.add("PLAN: missing: the path of a plan");
    if (!out.is_given()) problems.add("--out: missing: the database to write, or to continue");
    sweep.store = out.text;
    sweep.version = process::kVersion;
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
    sweep.known = known.text;
    if (launcher.is_given()) is_one_of({"local", "slurm"}, "--launcher", launcher.text, problems);
    is_slurm = launcher.text == "slurm";
    check_launcher(problems);
    for (const auto& [option, name] : {std::pair{&board, "--board"},
                                       {&calibration, "--calibration"},
                                       {&known, "--known"},
                                       {&progress, "--progress"}}) {
      if (option->is_given() && option->text.empty()) problems.add(fmt::format("{}: empty", name));
    }
    if (!progress.text.empty()) check_progress(problems);
    problems.check();
  }

 private:
  // It replaces the file: that must be none of a user's.
  void check_progress(process::Problems& problems) {
    for (const auto& [file, name] : {std::pair{&out, "--out"}, {&plan, "PLAN"}, {&known, "--known"}}) {
      if (file->text.empty() || !is_same_file(progress.text, file->text)) continue;
      problems.add(fmt::format("--progress = {}: is the file of {}", progress.text, name));
      return;
    }
    std::error_code none;
    const bool is_there = std::filesystem::exists(std::filesystem::symlink_status(progress.text, none));
    if (is_there && !is_counts_file(progress.text)) {
      problems.add(
          fmt::format("--progress = {}: is there, and not as a file of --progress: remove it, or give "
                      "another file",
                      progress.text));
    }
  }

  void check_launcher(process::Problems& problems) {
    const auto refuse_given = [&problems](bool is_given, const char* name, const char* rule) {
      if (is_given) problems.add(fmt::format("{}: {}", name, rule));
    };
    if (!is_slurm) {
      refuse_given(shards_option.is_given(), "--shards", "goes with --launcher slurm");
      refuse_given(sbatch.is_given(), "--sbatch", "goes with --launcher slurm");
      return;
    }
    refuse_given(jobs.is_given(), "--jobs", "not with --launcher slurm: --sbatch cpus-per-task=N");
    refuse_given(shard.is_given(), "--shard", "not with --launcher slurm, which submits all shards");
    refuse_given(known.is_given(), "--known", "not with --launcher slurm");
    refuse_given(progress.is_given(), "--progress", "not with --launcher slurm");
    if (shards_option.is_given()) {
      const auto number = number_of<std::uint64_t>(shards_option.text);
      if (!number || *number < 1 || *number > kMostShards) {
        problems.add(fmt::format("--shards = {}: must be 1..{}", shards_option.text, kMostShards));
      } else {
        shards = *number;
      }
    }
    for (const std::string& option : sbatch.text) {
      check_sbatch(option, problems);
      sbatch_options.push_back("--" + option);
    }
  }

  // What the launcher gives sbatch itself cannot be given.
  static void check_sbatch(const std::string& option, process::Problems& problems) {
    const std::vector<std::string> own = {"array",  "dependency", "error", "job-name",
                                          "output", "wait",       "wrap"};
    const std::string name = option.substr(0, option.find('='));
    const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || c == '-'; };
    if (name.empty() || name[0] == '-' || !std::all_of(name.begin(), name.end(), is_letter)) {
      problems.add(fmt::format(
          "--sbatch = {}: must be a long option of sbatch without its dashes, such as partition=long",
          option));
    } else if (std::find(own.begin(), own.end(), name) != own.end()) {
      problems.add(fmt::format("--sbatch = {}: given by the launcher; others may be given", option));
    }
  }

  void check_shard(process::Problems& problems) {
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

// `before`: points that were done when the seconds began.
std::string progress_text(const explore::SweepCounts& counts, std::uint64_t before, double seconds) {
  const auto done = static_cast<double>(counts.done());
  const double rate = (done - static_cast<double>(before)) / seconds;
  return fmt::format("{}/{} points   {:.1f} %   {:.1f} points/s   {} left", counts.done(), counts.total,
                     100 * done / static_cast<double>(counts.total), rate,
                     runs::time_text((static_cast<double>(counts.total) - done) / rate));
}

explore::Plan load_plan(const SweepCommandOptions& options) {
  try {
    return explore::Plan::load(options.plan.text, options.board.text);
  } catch (const platform::BoardError& error) {
    process::Problems problems;
    problems.add(error);
    problems.check();
    throw;
  }
}

// The calibration of all points, if they have one; the plan is given its tables. Refused if no point can have
// them.
std::optional<runs::CalibrationInput> calibration_of(const SweepCommandOptions& options,
                                                     explore::Plan& plan) {
  const bool is_option = !options.calibration.text.empty();
  const std::string path = is_option ? options.calibration.text : plan.calibration();
  if (path.empty()) return std::nullopt;
  const std::string named = is_option
                                ? "--calibration"
                                : fmt::format("{}: {}", plan.calibration_place(), explore::kCalibrationPath);
  process::Problems problems;
  auto calibration = runs::load_calibration(path, nullptr, problems, named);
  if (calibration) {
    const calib::Rig& rig = calibration->calibration->rig;
    const auto problem = plan.use_calibration(runs::sha256_of(calibration->tables), rig.width, rig.height);
    if (problem) problems.add(fmt::format("{} '{}': {}", named, path, *problem));
  }
  problems.check();
  return calibration;
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

int report(const explore::SweepCounts& counts, const SweepCommandOptions& options) {
  std::string text = summary(counts, options);
  if (std::filesystem::exists(options.sweep.store)) {
    explore::Database store(options.sweep.store, explore::Database::Access::kRead);
    text += fmt::format("{}: {} points\n", options.sweep.store, store.number("SELECT count(*) FROM points"));
    text += reasons(store, "failed") + reasons(store, "impossible");
  }
  process::print(text);
  if (counts.done() == counts.total) return kDone;
  process::say("note", "interrupted: the same command goes on where this one has ended");
  return kInterrupted;
}

// What follows the text of an error; empty if the database cannot be read.
std::string kept_text(const std::string& store, const std::string& advice) {
  try {
    explore::Database(store, explore::Database::Access::kRead, kBriefPatience)
        .number("SELECT count(*) FROM points");
    return "; what is done is kept: " + advice;
  } catch (const explore::DatabaseError&) {
    return "";
  }
}

// The file of --progress, if there is any.
class ProgressFile {
 public:
  explicit ProgressFile(const std::string& path) : path_(path) {
    if (!path.empty()) files::remove_left_aside(path);
  }
  void show(const explore::SweepCounts& counts) {
    const auto now = std::chrono::steady_clock::now();
    if (now >= next_) write(counts);
  }
  void write(const explore::SweepCounts& counts) {
    if (path_.empty()) return;
    files::replace_file(path_, explore::counts_text(counts));
    next_ = std::chrono::steady_clock::now() + kBetweenCounts;
  }

 private:
  std::string path_;
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

int sweep_here(const SweepCommandOptions& options, const explore::Plan& plan,
               const std::optional<runs::CalibrationInput>& calibration) {
  check_open_files(options.sweep.jobs, plan.size());
  ProgressFile file(options.progress.text);
  try {
    if (!options.sweep.known.empty()) {
      const explore::FinishedStore known(options.sweep.known, options.sweep.version);
    }
  } catch (const explore::DatabaseError& error) {
    process::refuse(fmt::format("--known {}", error.what()));
  }
  try {
    const explore::StoreLock lock(options.sweep.store);
    const auto open_store = [&] {
      explore::Store(options.sweep.store, options.sweep.version).check_banks(plan.banks());
    };
    if (std::filesystem::file_size(options.sweep.store) > 0) open_store();
    file.write({});
    open_store();  // a new one is made when nothing else is wrong
  } catch (const explore::DatabaseError& error) {
    process::refuse(fmt::format("--out {}", error.what()));
  } catch (const std::system_error& error) {
    process::refuse(fmt::format("--progress {}: {}", options.progress.text, error.code().message()));
  }
  process::catch_interrupts();
  runs::PointSimulator simulator =
      calibration ? runs::PointSimulator(calibration->tables) : runs::PointSimulator();
  runs::ProgressLine progress;
  explore::SweepCounts counts;
  try {
    counts = explore::sweep(
        plan, [&simulator](const explore::Point& point) { return simulator(point); }, options.sweep,
        [&progress, &file](const explore::SweepCounts& done) {
          progress.show([&done](double seconds) { return progress_text(done, 0, seconds); });
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
    throw std::runtime_error(error.what() + kept_text(options.sweep.store, "correct the plan"));
  } catch (const std::exception& error) {
    progress.erase();
    throw std::runtime_error(error.what() +
                             kept_text(options.sweep.store, "the same command goes on with it"));
  }
  return report(counts, options);
}

// What tasks on other machines need of the files that the plan is made of.
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
  sweep.version = options.sweep.version;
  sweep.points = plan.size();
  sweep.shards = std::min(options.shards, plan.size());
  return sweep;
}

std::string progress_text(const explore::SlurmProgress& progress, std::uint64_t before, double seconds) {
  std::string text = progress_text(progress.counts, before, seconds);
  text += fmt::format("   {} running", progress.running);
  if (progress.waiting > 0) text += fmt::format(", {} waiting", progress.waiting);
  if (!progress.reason.empty()) text += fmt::format(" ({})", progress.reason);
  return text;
}

int sweep_on_slurm(const SweepCommandOptions& options, const explore::Plan& plan,
                   const std::optional<runs::CalibrationInput>& calibration) {
  runs::ProgressLine progress;
  const auto say_note = [&progress](const std::string& note) {
    progress.erase();
    process::say("note", note);
  };
  const auto opened = [&] {
    try {
      return explore::SlurmSweep(sharded(options, plan, calibration), options.sweep.store,
                                 options.sbatch_options, say_note);
    } catch (const explore::DatabaseError& error) {
      process::refuse(fmt::format("--out {}", error.what()));
    } catch (const std::system_error& error) {
      process::refuse(fmt::format("--out {}: {}", options.sweep.store, error.code().message()));
    }
  };
  explore::SlurmSweep sweep = opened();
  process::catch_interrupts();
  try {
    sweep.begin();
  } catch (const explore::DatabaseError& error) {
    process::refuse(fmt::format("--out {}", error.what()));
  } catch (const std::exception& error) {
    process::refuse(fmt::format("--launcher slurm: {}", error.what()));
  }
  std::optional<std::uint64_t> before;
  const auto counts = sweep.wait([&](const explore::SlurmProgress& now) {
    if (!before) before = now.counts.done();
    progress.show([&](double seconds) { return progress_text(now, *before, seconds); });
    return !process::interrupted();
  });
  progress.erase();
  return report(counts, options);
}

int sweep(const SweepCommandOptions& options) {
  explore::Plan plan = load_plan(options);
  const auto calibration = calibration_of(options, plan);
  return options.is_slurm ? sweep_on_slurm(options, plan, calibration)
                          : sweep_here(options, plan, calibration);
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
