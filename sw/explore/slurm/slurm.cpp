#include "sw/explore/slurm/slurm.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <sstream>

#include "sw/process/command.h"

namespace stereotlm::explore {
namespace {

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, separator);) parts.push_back(part);
  return parts;
}

// Turns "sbatch: error: one\nsbatch: error: another\n" into "sbatch: one; another".
std::string words_of(const std::string& program, const process::CommandEnd& end) {
  std::string words;
  for (std::string line : split(end.errors.empty() ? end.out : end.errors, '\n')) {
    for (const std::string& prefix : {program + ": ", std::string("error: ")}) {
      if (line.compare(0, prefix.size(), prefix) == 0) line.erase(0, prefix.size());
    }
    if (!line.empty()) words += (words.empty() ? "" : "; ") + line;
  }
  if (words.empty()) words = fmt::format("has ended with status {}", end.status);
  return program + ": " + words;
}

std::string run(const std::vector<std::string>& words) {
  try {
    // Runs without the variables SQUEUE_.. and SCANCEL_.., which users set for interactive use. Keeps
    // SBATCH_.., which also apply to jobs that programs submit.
    const process::CommandEnd end = process::run_command(words, {"SQUEUE_", "SCANCEL_"});
    if (end.status != 0) throw SlurmError(words_of(words[0], end));
    return end.out;
  } catch (const process::CommandMissing& missing) {
    throw SlurmError(
        fmt::format("{}; Slurm's commands sbatch, squeue and scancel are needed", missing.what()));
  }
}

std::optional<std::uint64_t> number_of(const std::string& text) {
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

}  // namespace

bool SlurmTask::is_live() const {
  // The states of ended jobs, from "JOB STATE CODES" in the manual of squeue.
  constexpr std::array kEnded = {"BOOT_FAIL", "CANCELLED",     "COMPLETED", "DEADLINE", "FAILED",
                                 "NODE_FAIL", "OUT_OF_MEMORY", "PREEMPTED", "REVOKED",  "TIMEOUT"};
  return std::find(kEnded.begin(), kEnded.end(), state) == kEnded.end();
}

std::vector<SlurmTask> slurm_jobs(const std::string& name) {
  const std::string text =
      run({"squeue", "--noheader", "--array", "--states=all", "--name=" + name, "--format=%F|%K|%T|%r"});
  std::vector<SlurmTask> tasks;
  for (const std::string& line : split(text, '\n')) {
    const std::vector<std::string> parts = split(line, '|');
    if (parts.size() != 4 || !number_of(parts[0]))
      throw SlurmError(fmt::format("squeue: unexpected output: {}", line));
    tasks.push_back({parts[0], number_of(parts[1]), parts[2], parts[3]});
  }
  return tasks;
}

std::string submit_to_slurm(const std::vector<std::string>& options, const std::string& script,
                            const std::vector<std::string>& arguments) {
  std::vector<std::string> words = {"sbatch"};
  words.insert(words.end(), options.begin(), options.end());
  words.insert(words.end(), {"--parsable", script});
  words.insert(words.end(), arguments.begin(), arguments.end());
  const std::string said = run(words);  // "12", or "12;cluster"
  const std::string job = said.substr(0, said.find_first_of(";\n"));
  if (!number_of(job)) throw SlurmError(fmt::format("sbatch: no job number in its output: {}", job));
  return job;
}

void cancel_in_slurm(const std::vector<std::string>& jobs) {
  std::vector<std::string> words = {"scancel"};
  words.insert(words.end(), jobs.begin(), jobs.end());
  run(words);
}

std::string array_text(const std::vector<std::uint64_t>& numbers) {
  std::string text;
  for (std::size_t first = 0; first < numbers.size();) {
    std::size_t last = first;
    while (last + 1 < numbers.size() && numbers[last + 1] == numbers[last] + 1) ++last;
    if (!text.empty()) text += ',';
    text += std::to_string(numbers[first]);
    if (last > first) text += fmt::format("-{}", numbers[last]);
    first = last + 1;
  }
  return text;
}

}  // namespace stereotlm::explore
