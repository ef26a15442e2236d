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
      name_(name_of(folder_.path())),
      shards_(sweep.shards),
      done_(sweep.shards) {}

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
    if (is_at_work) say_(fmt::format("the jobs are there already: {}", fmt::join(live_jobs_, ", ")));
    submit_missing();
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
      if (folder_.is_merged() && live_jobs_.empty()) break;
      submit_missing();
      failures = 0;
    } catch (const SlurmError& error) {
      if (++failures == kMostFailures) {
        throw SlurmError(fmt::format("{}; {}", error.what(), kJobsContinue));
      }
      if (failures == 1) say_(fmt::format("{}: asking again", error.what()));
      continue;
    }
    if (live_jobs_.empty() && !folder_.is_merged()) give_up();
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
  merge_.is_live = false;
  for (Work& shard : shards_) shard.is_live = false;
  for (const SlurmTask& task : tasks) take(task);
  for (std::uint64_t shard = 0; shard < sweep_.shards; ++shard) {
    SweepCounts counts = folder_.counts(shard);
    done_[shard] = counts.done();
    counts.total = sweep_.points_of(shard);
    progress_.counts.add(counts);
  }
}

void SlurmSweep::take(const SlurmTask& task) {
  if (task.is_live()) live_jobs_.insert(task.job);
  if (task.index && *task.index >= sweep_.shards) return;  // belongs to another sweep into this store
  Work& work = task.index ? shards_[*task.index] : merge_;
  if (!task.is_live()) {
    if (work.job == task.job) work.end = task.state;
    return;
  }
  work.job = task.job;
  work.is_live = true;
  work.end.clear();
  if (!task.index) return;
  const bool waits = task.state == "PENDING";
  ++(waits ? progress_.waiting : progress_.running);
  if (waits && progress_.reason.empty()) progress_.reason = task.reason;
}

// Submits the shards that are neither finished nor live: all shards at first, lost shards later.
void SlurmSweep::submit_missing() {
  std::vector<std::uint64_t> missing;
  std::vector<std::uint64_t> lost;
  bool is_whole = true;
  for (std::uint64_t shard = 0; shard < sweep_.shards; ++shard) {
    if (folder_.is_whole(shard)) continue;
    is_whole = false;
    Work& work = shards_[shard];
    if (work.is_live || work.is_given_up) continue;
    if (!work.job.empty()) lost.push_back(shard);
    if (may_continue(work, done_[shard])) missing.push_back(shard);
  }
  if (!lost.empty()) {
    const std::string& end = shards_[lost.front()].end;
    say_(fmt::format("lost: {} ({}); submitting {}", shards_text(lost),
                     end.empty() ? "gone from the queue" : end,
                     missing.empty()                 ? "no more"
                     : missing.size() == lost.size() ? "again"
                                                     : shards_text(missing)));
  }
  if (!missing.empty()) {
    submit_shards(missing);
    submit_merge();
  } else if (is_whole && !folder_.is_merged() && !merge_.is_live && !merge_.is_given_up &&
             may_continue(merge_, 0)) {
    submit_merge();
  }
}

void SlurmSweep::submit_shards(const std::vector<std::uint64_t>& shards) {
  const std::string job =
      submit(folder_.task_script(), ShardFolder::task_log("%a"), {"--array=" + array_text(shards)});
  for (const std::uint64_t shard : shards) {
    shards_[shard].job = job;
    shards_[shard].is_live = true;
    shards_[shard].end.clear();
  }
  progress_.waiting += shards.size();
  say_(fmt::format("job {}: {} of {}", job, shards_text(shards), sweep_.shards));
}

// Submits the merge, which starts after all live jobs. Its script checks that all shards are whole.
void SlurmSweep::submit_merge() {
  if (merge_.is_live) {
    cancel_in_slurm({merge_.job});
    live_jobs_.erase(merge_.job);
    merge_.is_live = false;
  }
  std::vector<std::string> options;
  if (!live_jobs_.empty())
    options.push_back(fmt::format("--dependency=afterany:{}", fmt::join(live_jobs_, ":")));
  merge_.job = submit(folder_.merge_script(), ShardFolder::kMergeLog, options);
  merge_.is_live = true;
  merge_.end.clear();
  say_(fmt::format("job {}: the merge into {}", merge_.job, folder_.store()));
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
  return job;
}

// Counts a loss if the work was submitted before. Gives the work up at loss number kMostLosses, and returns
// false then.
bool SlurmSweep::may_continue(Work& work, std::uint64_t done) const {
  if (work.job.empty()) return true;
  work.losses = done > work.most_done ? 1 : work.losses + 1;
  work.most_done = std::max(work.most_done, done);
  work.is_given_up = work.losses == kMostLosses;
  return !work.is_given_up;
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

void SlurmSweep::give_up() const {
  const auto is_given_up = [](const Work& work) { return work.is_given_up; };
  const auto shard = std::find_if(shards_.begin(), shards_.end(), is_given_up);
  const auto number = std::to_string(shard - shards_.begin());
  const bool is_merge = shard == shards_.end();
  const std::string log =
      folder_.path() + '/' + (is_merge ? ShardFolder::kMergeLog : ShardFolder::task_log(number));
  const std::string& end = is_merge ? merge_.end : shard->end;
  throw std::runtime_error(fmt::format(
      "{} has been lost {} times without a further point ({}); {}; finished points are kept in {}: run the "
      "same "
      "command to resume",
      is_merge ? "the merge" : "shard " + number, kMostLosses, end.empty() ? "gone from the queue" : end,
      std::filesystem::exists(log) ? fmt::format("its log {} ends with: {}", log, ShardFolder::last_line(log))
                                   : fmt::format("there is no {}: the nodes must share this folder", log),
      folder_.path()));
}

}  // namespace stereotlm::explore
