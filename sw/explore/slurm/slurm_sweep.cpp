#include "sw/explore/slurm/slurm_sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <stdexcept>
#include <thread>
#include <utility>

#include "sw/files/sha256.h"

namespace stereotlm::explore {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr int kMostLosses = 3;
constexpr int kMostFailures = 10;     // successive failures of Slurm's commands
constexpr auto kCancelTimeout = 60s;  // until the cancelled jobs have ended
constexpr auto kPollInterval = 100ms;
constexpr const char* kJobsContinue = "the jobs continue; run the same command to wait for them";

// The time between two queries to Slurm, which serves many users: a twentieth of the elapsed time.
Clock::duration interval(Clock::duration elapsed) {
  return std::clamp<Clock::duration>(elapsed / 20, 1s, 30s);
}

std::string name_of(const std::string& folder) {
  constexpr std::size_t kDigits = 12;
  return "sweep-" + files::sha256_hex(folder.data(), folder.size()).substr(0, kDigits);
}

// Escapes a path for sbatch, which replaces %a and the like in paths of logs.
std::string without_patterns(const std::string& path) {
  std::string text;
  for (const char c : path) text += c == '%' ? "%%" : std::string(1, c);
  return text;
}

std::string shards_text(const std::vector<std::uint64_t>& shards) {
  return (shards.size() == 1 ? "shard " : "shards ") + array_text(shards);
}

}  // namespace

SlurmSweep::SlurmSweep(const ShardedSweep& sweep, const std::string& store,
                       const std::vector<std::string>& options, Say say)
    : sweep_(sweep),
      options_(options),
      say_(std::move(say)),
      folder_(store),
      name_(name_of(folder_.path())) {}

// Makes all checks that can refuse the sweep before it changes anything.
void SlurmSweep::begin() {
  const std::vector<SlurmTask> tasks = slurm_jobs(name_);
  const bool is_at_work =
      std::any_of(tasks.begin(), tasks.end(), [](const SlurmTask& task) { return task.is_live(); });
  if (is_at_work && !folder_.is_of(sweep_)) {
    throw std::runtime_error(
        fmt::format("{}: jobs of another plan, board, number of shards or version are at work for it: wait "
                    "for them, or cancel them (scancel --name={})",
                    folder_.store(), name_));
  }
  bool is_new = !folder_.exists();
  folder_.lock();
  try {
    if (!folder_.is_of(sweep_)) {
      folder_.keep_points(sweep_.version);
      is_new = true;
      folder_.begin(sweep_);
    }
    refresh();
    if (is_at_work) {
      say_(fmt::format("the jobs are there already: {}", fmt::join(live_jobs_, ", ")));
    } else if (!folder_.is_merged()) {
      submit_round();
    }
  } catch (...) {
    if (is_new) {
      if (!live_jobs_.empty()) cancel_in_slurm({live_jobs_.begin(), live_jobs_.end()});
      folder_.remove();
    }
    throw;
  }
}

SweepCounts SlurmSweep::wait(const std::function<bool(const SlurmProgress&)>& keep_going) {
  const auto start = Clock::now();
  int failures = 0;
  for (;;) {
    const auto next_query = Clock::now() + interval(Clock::now() - start);
    while (Clock::now() < next_query) {
      if (!keep_going(progress_)) {
        cancel();
        return progress_.counts;
      }
      std::this_thread::sleep_for(kPollInterval);
    }
    try {
      refresh();
      if (live_jobs_.empty() && folder_.is_merged()) break;
      if (live_jobs_.empty()) submit_round();
      failures = 0;
    } catch (const SlurmError& error) {
      if (++failures == kMostFailures) {
        throw SlurmError(fmt::format("{}; {}", error.what(), kJobsContinue));
      }
      if (failures == 1) say_(fmt::format("{}: asking again", error.what()));
    }
  }
  folder_.remove();
  return progress_.counts;
}

// Queries Slurm before it lists the folder: a task that has ended in Slurm has written all its files.
void SlurmSweep::refresh() {
  const std::vector<SlurmTask> tasks = slurm_jobs(name_);
  folder_.refresh();
  live_jobs_.clear();
  progress_ = {};
  for (const SlurmTask& task : tasks) {
    if (!task.is_live()) {
      if (jobs_.count(task.job) > 0) ends_[task.index] = task.state;
      continue;
    }
    live_jobs_.insert(task.job);
    jobs_.insert(task.job);
    if (!task.index) continue;
    const bool waits = task.state == "PENDING";
    ++(waits ? progress_.waiting : progress_.running);
    if (waits && progress_.reason.empty()) progress_.reason = task.reason;
  }
  for (std::uint64_t shard = 0; shard < sweep_.shards; ++shard) progress_.counts.add(folder_.counts(shard));
  progress_.counts.total = sweep_.points;
}

void SlurmSweep::submit_round() {
  std::vector<std::uint64_t> missing;
  for (std::uint64_t shard = 0; shard < sweep_.shards; ++shard) {
    if (!folder_.is_whole(shard)) missing.push_back(shard);
  }
  if (!jobs_.empty()) end_round(missing);
  std::vector<std::string> behind;
  if (!missing.empty()) {
    const std::string job =
        submit(folder_.task_script(), ShardFolder::task_log("%a"), {"--array=" + array_text(missing)});
    progress_.waiting += missing.size();
    say_(fmt::format("job {}: {} of {}", job, shards_text(missing), sweep_.shards));
    behind = {"--dependency=afterany:" + job};
  }
  const std::string merge = submit(folder_.merge_script(), ShardFolder::kMergeLog, behind);
  say_(fmt::format("job {}: the merge into {}", merge, folder_.store()));
}

// Throws at round number kMostLosses that has ended without a further point.
void SlurmSweep::end_round(const std::vector<std::uint64_t>& missing) {
  const std::uint64_t done = progress_.counts.done();
  losses_ = done > most_done_ ? 1 : losses_ + 1;
  most_done_ = std::max(most_done_, done);
  if (losses_ == kMostLosses) give_up(missing);
  if (!missing.empty())
    say_(fmt::format("lost: {} ({}); submitting again", shards_text(missing), end_of(missing.front())));
  jobs_.clear();
  ends_.clear();
}

std::string SlurmSweep::end_of(std::optional<std::uint64_t> shard) const {
  const auto end = ends_.find(shard);
  return end == ends_.end() ? "gone from the queue" : end->second;
}

std::string SlurmSweep::submit(const std::string& script, const std::string& log,
                               const std::vector<std::string>& options) {
  std::vector<std::string> all = options_;
  all.insert(all.end(), {"--job-name=" + name_, "--open-mode=append",
                         fmt::format("--output={}/{}", without_patterns(folder_.path()), log)});
  all.insert(all.end(), options.begin(), options.end());
  const std::string program = std::filesystem::read_symlink("/proc/self/exe").string();
  const std::string job =
      submit_to_slurm(all, script, {program, folder_.path(), std::to_string(sweep_.shards), folder_.store()});
  live_jobs_.insert(job);
  jobs_.insert(job);
  return job;
}

void SlurmSweep::cancel() {
  try {
    if (!live_jobs_.empty()) cancel_in_slurm({live_jobs_.begin(), live_jobs_.end()});
    for (const auto end = Clock::now() + kCancelTimeout; !live_jobs_.empty(); refresh()) {
      if (Clock::now() > end) {
        say_(fmt::format("the jobs have not ended yet; their finished points are in {}", folder_.path()));
        return;
      }
      std::this_thread::sleep_for(1s);
    }
  } catch (const SlurmError& error) {
    throw SlurmError(fmt::format("{}; {}", error.what(), kJobsContinue));
  }
  folder_.keep_points(sweep_.version);
  folder_.remove();
}

void SlurmSweep::give_up(const std::vector<std::uint64_t>& missing) const {
  const bool is_merge = missing.empty();
  const std::string number = is_merge ? "" : std::to_string(missing.front());
  const std::string log =
      folder_.path() + '/' + (is_merge ? ShardFolder::kMergeLog : ShardFolder::task_log(number));
  throw std::runtime_error(fmt::format(
      "{} has been lost {} times without a further point ({}); {}; finished points are kept in {}: run the "
      "same "
      "command to resume",
      is_merge ? "the merge" : "shard " + number, kMostLosses,
      end_of(is_merge ? std::nullopt : std::optional(missing.front())),
      std::filesystem::exists(log) ? fmt::format("its log {} ends with: {}", log, ShardFolder::last_line(log))
                                   : fmt::format("there is no {}: the nodes must share this folder", log),
      folder_.path()));
}

}  // namespace stereotlm::explore
