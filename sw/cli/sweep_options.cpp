#include "sw/cli/sweep_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <string_view>
#include <thread>
#include <utility>

#include "sw/files/whole_file.h"
#include "sw/process/installation.h"

namespace stereotlm::cli {
namespace {

constexpr unsigned kMostJobs = 1024;
constexpr std::uint64_t kMostShards = 1000;  // the merge opens the files of all shards
constexpr std::uint64_t kDefaultShards = 16;

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

}  // namespace

void SweepCommandOptions::add_to(CLI::App& command) {
  plan.add_to(command, "PLAN", " ", "The plan's file");
  out_.add_to(command, "--out", "DB", "The database to write, or to continue");
  jobs_.add_to(command, "--jobs", "N", "Worker processes; default: the processors of this machine");
  shard.add_to(command, "--shard", "I/N",
               "Only every N-th point, from number I on (0 .. N-1); see stereotlm merge");
  board.add_to(command, "--board", "BOARD", "In place of the board that the plan names");
  calibration.add_to(command, "--calibration", "F", "In place of the calibration that the plan names");
  known_.add_to(command, "--known", "DB2", "A database, only read, whose points are not run either");
  progress.add_to(command, "--progress", "F", "Keep in this file how many points are done");
  launcher_.add_to(command, "--launcher", "WHERE", "Where it runs: local, the default, or slurm");
  shards_.add_to(command, "--shards", "N",
                 fmt::format("With slurm: the tasks of the job array (default {})", kDefaultShards));
  sbatch_.add_to(
      command, "--sbatch", "NAME=VALUE",
      "With slurm: an option of sbatch for all jobs, such as partition=long or time=8:00:00; again "
      "for further ones");
  sbatch_.takes_one_at_a_time();
}

void SweepCommandOptions::check_usage() {
  process::Problems problems;
  if (!plan.is_given()) problems.add("PLAN: missing: the path of a plan");
  if (!out_.is_given()) problems.add("--out: missing: the database to write, or to continue");
  sweep.store = out_.text;
  sweep.version = process::kVersion;
  sweep.known = known_.text;
  check_jobs(problems);
  if (shard.is_given()) check_shard(problems);
  check_launcher(problems);
  for (const auto& [option, name] : {std::pair{&board, "--board"},
                                     {&calibration, "--calibration"},
                                     {&known_, "--known"},
                                     {&progress, "--progress"}}) {
    if (option->is_given() && option->text.empty()) problems.add(fmt::format("{}: empty", name));
  }
  if (!progress.text.empty()) check_progress(problems);
  problems.check();
}

void SweepCommandOptions::check_jobs(process::Problems& problems) {
  sweep.jobs = std::max(1U, std::thread::hardware_concurrency());
  if (!jobs_.is_given()) return;
  const auto number = number_of<unsigned>(jobs_.text);
  if (!number || *number < 1 || *number > kMostJobs) {
    problems.add(fmt::format("--jobs = {}: must be 1..{}", jobs_.text, kMostJobs));
  } else {
    sweep.jobs = *number;
  }
}

void SweepCommandOptions::check_shard(process::Problems& problems) {
  const std::string_view text = shard.text;
  const std::size_t slash = std::min(text.find('/'), text.size());
  const auto index = number_of<std::uint64_t>(text.substr(0, slash));
  const auto count = number_of<std::uint64_t>(text.substr(std::min(slash + 1, text.size())));
  if (!index || !count || *index >= *count) {
    problems.add(fmt::format("--shard = {}: must be I/N with I in 0 .. N-1, such as 0/4", text));
    return;
  }
  sweep.shard = *index;
  sweep.shards = *count;
}

void SweepCommandOptions::check_launcher(process::Problems& problems) {
  if (launcher_.is_given()) is_one_of({"local", "slurm"}, "--launcher", launcher_.text, problems);
  is_slurm = launcher_.text == "slurm";
  shards = kDefaultShards;
  const auto refuse_given = [&problems](bool is_given, const char* name, const char* rule) {
    if (is_given) problems.add(fmt::format("{}: {}", name, rule));
  };
  if (!is_slurm) {
    refuse_given(shards_.is_given(), "--shards", "goes with --launcher slurm");
    refuse_given(sbatch_.is_given(), "--sbatch", "goes with --launcher slurm");
    return;
  }
  refuse_given(jobs_.is_given(), "--jobs", "not with --launcher slurm: --sbatch cpus-per-task=N");
  refuse_given(shard.is_given(), "--shard", "not with --launcher slurm, which submits all shards");
  refuse_given(known_.is_given(), "--known", "not with --launcher slurm");
  refuse_given(progress.is_given(), "--progress", "not with --launcher slurm");
  if (shards_.is_given()) {
    const auto number = number_of<std::uint64_t>(shards_.text);
    if (!number || *number < 1 || *number > kMostShards) {
      problems.add(fmt::format("--shards = {}: must be 1..{}", shards_.text, kMostShards));
    } else {
      shards = *number;
    }
  }
  for (const std::string& option : sbatch_.text) {
    check_sbatch(option, problems);
    sbatch_options.push_back("--" + option);
  }
}

files::OutputFile SweepCommandOptions::progress_file() const {
  const files::FileKind kind = {"file of --progress", [](const std::filesystem::path& path) {
                                  const std::string text = files::read_whole_file(path);
                                  return text == explore::counts_text(explore::read_counts(text));
                                }};
  return files::OutputFile(progress.text, kind,
                           {{"--out", out_.text}, {"PLAN", plan.text}, {"--known", known_.text}});
}

// --progress replaces its file, which must therefore not be another file of the user.
void SweepCommandOptions::check_progress(process::Problems& problems) const {
  try {
    progress_file();
  } catch (const std::runtime_error& error) {
    problems.add(fmt::format("--progress {}", error.what()));
  }
}

}  // namespace stereotlm::cli
