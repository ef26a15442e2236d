#include "sw/cli/sweep_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <thread>
#include <utility>

#include "sw/files/whole_file.h"
#include "sw/process/installation.h"

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

}  // namespace

Rule SweepCommandOptions::is_shard() {
  return valid("I/N with I in 0 .. N-1, such as 0/4",
               [](const std::string& text) { return shard_of(text).has_value(); });
}

void SweepCommandOptions::not_empty(const Option& option, process::Problems& problems) {
  if (option.is_given() && option.text().empty()) problems.add(option.name() + ": empty");
}

void SweepCommandOptions::check_together(process::Problems& problems) {
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
  if (progress.text().empty()) return;
  try {
    progress_file();  // it is replaced, and must therefore not be another file of the user
  } catch (const std::runtime_error& error) {
    problems.add(fmt::format("--progress {}", error.what()));
  }
}

explore::SweepOptions SweepCommandOptions::sweep() const {
  explore::SweepOptions options;
  options.store = out.text();
  options.version = process::kVersion;
  options.known = known.text();
  options.jobs = jobs.number<unsigned>().value_or(std::max(1U, std::thread::hardware_concurrency()));
  std::tie(options.shard, options.shards) = shard_of(shard.text()).value_or(std::pair(0, 1));
  return options;
}

std::uint64_t SweepCommandOptions::tasks() const {
  return shards.number<std::uint64_t>().value_or(kDefaultShards);
}

std::vector<std::string> SweepCommandOptions::sbatch_options() const {
  std::vector<std::string> options;
  for (const std::string& option : sbatch.texts()) options.push_back("--" + option);
  return options;
}

files::OutputFile SweepCommandOptions::progress_file() const {
  const files::FileKind kind = {"file of --progress", [](const std::filesystem::path& path) {
                                  const std::string text = files::read_whole_file(path);
                                  return text == explore::counts_text(explore::read_counts(text));
                                }};
  return files::OutputFile(progress.text(), kind,
                           {{"--out", out.text()}, {"PLAN", plan.text()}, {"--known", known.text()}});
}

}  // namespace stereotlm::cli
