#include "sw/explore/slurm/slurm.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <sstream>
#include <system_error>
#include <thread>

#include "sw/explore/store/store.h"
#include "sw/files/aside.h"
#include "sw/files/text_forms.h"
#include "sw/files/whole_file.h"
#include "sw/process/command.h"

namespace stereotlm::explore {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using Words = std::vector<std::string>;
using namespace std::chrono_literals;

constexpr int kMostLosses = 3;
constexpr int kMostFailures = 10;     // successive failures of Slurm's commands
constexpr auto kCancelTimeout = 60s;  // until the cancelled jobs have ended
constexpr auto kPollInterval = 100ms;
constexpr const char* kJobsContinue = "the jobs continue; run the same command to wait for them";

// Files in the folder beside those of the sweep. Both scripts are called with PROGRAM FOLDER SHARDS STORE.
constexpr const char* kLock = "lock";
constexpr const char* kSweep = "sweep";
constexpr const char* kMergeLog = "merge.log";
constexpr const char* kTaskScript =
    R"(#!/bin/sh
program=$1 folder=$2 shards=$3 store=$4
shard=$folder/shard_$SLURM_ARRAY_TASK_ID
[ ! -e "$shard.db" ] || exit 0
set --
[ ! -e "$folder/board.yaml" ] || set -- --board "$folder/board.yaml"
[ ! -e "$folder/calibration.yaml" ] || set -- "$@" --calibration "$folder/calibration.yaml"
[ ! -e "$store" ] || set -- "$@" --known "$store"
"$program" sweep "$folder/plan.yaml" "$@" --shard "$SLURM_ARRAY_TASK_ID/$shards" \
  --jobs "${SLURM_CPUS_ON_NODE:-1}" --out "$shard.work" --progress "$shard.progress" &&
  mv "$shard.work" "$shard.db"
)";
constexpr const char* kMergeScript =
    R"(#!/bin/sh
program=$1 folder=$2 shards=$3 store=$4
for shard in $(seq 0 $((shards - 1))); do
  [ -e "$folder/shard_$shard.db" ] && continue
  echo "shard $shard is not finished: run the command that submitted it to resume" >&2
  exit 1
done
set -- "$folder"/shard_*.db
[ ! -e "$store" ] || set -- "$@" "$store"
"$program" merge "$store" "$@" && : >"$folder/merged"
)";

Words split(const std::string& text, char separator) {
  Words parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, separator);) parts.push_back(part);
  return parts;
}

bool is_number(const std::string& text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
}

// The contents of a file; empty if it does not exist.
std::string text_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// Runs a command of Slurm and returns its output. The command gets no variables SQUEUE_.. and SCANCEL_..,
// which users set for interactive use, but SBATCH_.., which also apply to jobs that programs submit. Throws
// SlurmError: "sbatch: one; another" for the message "sbatch: error: one\nsbatch: error: another\n".
std::string run(const Words& words) {
  const std::string& program = words[0];
  process::CommandEnd end;
  try {
    end = process::run_command(words, {"SQUEUE_", "SCANCEL_"});
  } catch (const process::CommandMissing& missing) {
    throw SlurmError(
        fmt::format("{}; Slurm's commands sbatch, squeue and scancel are needed", missing.what()));
  }
  if (end.status == 0) return end.out;
  std::string said;
  for (std::string line : split(end.errors.empty() ? end.out : end.errors, '\n')) {
    for (const std::string& prefix : {program + ": ", std::string("error: ")}) {
      if (line.compare(0, prefix.size(), prefix) == 0) line.erase(0, prefix.size());
    }
    if (!line.empty()) said += (said.empty() ? "" : "; ") + line;
  }
  if (said.find("job array") != std::string::npos)
    said += ": needs fewer --shards: each index is below MaxArraySize of the cluster (scontrol show config)";
  if (said.empty()) said = fmt::format("has ended with status {}", end.status);
  throw SlurmError(program + ": " + said);
}

void cancel_in_slurm(const std::set<std::string>& jobs) {
  Words words = {"scancel"};
  words.insert(words.end(), jobs.begin(), jobs.end());
  if (!jobs.empty()) run(words);
}

// A job, or one task of a job array, as squeue lists it.
struct Task {
  std::string job;                     // number of the job, or of the job array
  std::optional<std::uint64_t> index;  // of a task in its job array
  std::string state;                   // "PENDING", "RUNNING", "NODE_FAIL", ..
  std::string reason;                  // why it waits: "Resources", ..

  // Whether the task waits, runs, or still has processes. kEnded are the states of ended jobs, from "JOB
  // STATE CODES" in the manual of squeue.
  bool is_live() const {
    constexpr std::array kEnded = {"BOOT_FAIL", "CANCELLED",     "COMPLETED", "DEADLINE", "FAILED",
                                   "NODE_FAIL", "OUT_OF_MEMORY", "PREEMPTED", "REVOKED",  "TIMEOUT"};
    return std::find(kEnded.begin(), kEnded.end(), state) == kEnded.end();
  }
};

// The jobs with this name, including those that ended in the last minutes.
std::vector<Task> tasks_of(const std::string& name) {
  std::vector<Task> tasks;
  for (const std::string& line : split(
           run({"squeue", "--noheader", "--array", "--states=all", "--name=" + name, "--format=%F|%K|%T|%r"}),
           '\n')) {
    const Words parts = split(line, '|');
    if (parts.size() != 4 || !is_number(parts[0]))
      throw SlurmError(fmt::format("squeue: unexpected output: {}", line));
    tasks.push_back({parts[0], std::nullopt, parts[2], parts[3]});
    if (is_number(parts[1])) tasks.back().index = std::stoull(parts[1]);
  }
  return tasks;
}

std::string shards_text(const std::vector<std::uint64_t>& shards) {
  return (shards.size() == 1 ? "shard " : "shards ") + files::ranges_text(shards, ",");
}

// A text that is different for each sweep.
std::string identity(const ShardedSweep& sweep) {
  std::string text = fmt::format("version {}\nshards {}\n", sweep.version, sweep.shards);
  for (const auto& [name, bytes] : sweep.files)
    text += fmt::format("{} {}\n", name, files::sha256_hex(bytes.data(), bytes.size()));
  return text;
}

}  // namespace

SlurmSweep::~SlurmSweep() {
  if (lock_ >= 0) close(lock_);
}

// Makes all checks that can refuse the sweep before it changes anything.
void SlurmSweep::begin(const std::string& store) {
  std::error_code error;
  store_ = fs::weakly_canonical(fs::absolute(behind_links(store)), error).string();
  if (error) throw sqlite::DatabaseError(store + ": " + error.message());
  folder_ = store_ + ".shards";
  name_ = "sweep-" + files::sha256_hex(folder_.data(), folder_.size()).substr(0, 12);
  const std::vector<Task> tasks = tasks_of(name_);
  const bool is_at_work = std::any_of(tasks.begin(), tasks.end(), [](const Task& t) { return t.is_live(); });
  if (is_at_work && !is_of_this_sweep()) {
    throw std::runtime_error(
        fmt::format("{}: jobs of another plan, board, number of shards or version are at work for it: wait "
                    "for them, or cancel them (scancel --name={})",
                    store_, name_));
  }
  bool is_new = !fs::exists(folder_);
  lock();
  try {
    if (!is_of_this_sweep()) {
      keep_points();
      is_new = true;
      fill();
    }
    refresh();
    if (is_at_work) {
      say_(fmt::format("the jobs are there already: {}", fmt::join(live_jobs_, ", ")));
    } else if (!is_merged()) {
      submit_round();
    }
  } catch (...) {
    if (is_new) {
      cancel_in_slurm(live_jobs_);
      remove();
    }
    throw;
  }
}

// Makes the folder if there is none, and locks it until the end of this object or process.
void SlurmSweep::lock() {
  std::error_code error;
  fs::create_directory(folder_, error);
  if (error) throw std::runtime_error(fmt::format("{}: cannot be made: {}", folder_, error.message()));
  if (!fs::is_empty(folder_) && !fs::exists(file(kLock))) {
    throw std::runtime_error(folder_ +
                             ": exists, and is not a folder of shards: remove it, or give another --out");
  }
  lock_ = open(file(kLock).c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (lock_ >= 0 && flock(lock_, LOCK_EX | LOCK_NB) == 0) return;
  if (errno != EWOULDBLOCK) throw std::system_error(errno, std::generic_category(), file(kLock));
  throw std::runtime_error(folder_ + ": another process waits for these shards already");
}

bool SlurmSweep::is_of_this_sweep() const { return text_of(file(kSweep)) == identity(sweep_); }
bool SlurmSweep::is_merged() const { return names_.count("merged") > 0 && fs::exists(store_); }

// Merges the points of all shards, whole or not, into the store. No other process may write to the shards.
void SlurmSweep::keep_points() const {
  Words stores;
  for (const fs::path& name : files::entries(folder_)) {
    if (name.extension() == ".work") const Store completed(file(name), sweep_.version);
    if (name.extension() == ".work" || name.extension() == ".db") stores.push_back(file(name));
  }
  if (stores.empty()) return;
  const StoreLock lock(store_);
  if (fs::file_size(store_) > 0) stores.push_back(store_);
  merge_stores(stores, store_);
}

void SlurmSweep::empty() const {
  for (const fs::path& name : files::entries(folder_)) {
    if (name != kLock) fs::remove_all(file(name));
  }
}

void SlurmSweep::remove() const {
  empty();  // the lock last
  fs::remove_all(folder_);
}

// Replaces the contents of the folder by the files that the tasks need. If the store exists, merge_stores()
// rewrites it, so that many processes can read it at the same time.
void SlurmSweep::fill() const {
  if (fs::exists(store_)) {
    const StoreLock lock(store_);
    Store(store_, sweep_.version).check_banks(sweep_.banks);
    merge_stores({store_}, store_);
  }
  empty();
  for (const auto& [name, bytes] : sweep_.files) files::write_whole_file(file(name), bytes);
  files::write_whole_file(file("task.sh"), kTaskScript);
  files::write_whole_file(file("merge.sh"), kMergeScript);
  files::write_whole_file(file(kSweep), identity(sweep_));
}

SweepCounts SlurmSweep::wait(const std::function<bool(const SlurmProgress&)>& keep_going) {
  const auto start = Clock::now();
  int failures = 0;
  for (;;) {
    // Slurm serves many users: it is asked after a twentieth of the elapsed time.
    const auto next_query = Clock::now() + std::clamp<Clock::duration>((Clock::now() - start) / 20, 1s, 30s);
    while (Clock::now() < next_query) {
      if (!keep_going(progress_)) {
        cancel();
        return progress_.counts;
      }
      std::this_thread::sleep_for(kPollInterval);
    }
    try {
      refresh();
      if (live_jobs_.empty() && is_merged()) break;
      if (live_jobs_.empty()) submit_round();
      failures = 0;
    } catch (const SlurmError& error) {
      if (++failures == kMostFailures) throw SlurmError(fmt::format("{}; {}", error.what(), kJobsContinue));
      if (failures == 1) say_(fmt::format("{}: asking again", error.what()));
    }
  }
  remove();
  return progress_.counts;
}

// Asks Slurm before it lists the folder: a task that has ended in Slurm has written all its files. On NFS a
// query for a single name may fail for a minute after the file was made; the list of a folder is current.
void SlurmSweep::refresh() {
  const std::vector<Task> tasks = tasks_of(name_);
  names_.clear();
  for (const fs::path& name : files::entries(folder_)) names_.insert(name);
  live_jobs_.clear();
  progress_ = {};
  for (const Task& task : tasks) {
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
  for (std::uint64_t shard = 0; shard < sweep_.shards; ++shard)
    progress_.counts.add(read_counts(text_of(file(fmt::format("shard_{}.progress", shard)))));
  progress_.counts.total = sweep_.points;
}

void SlurmSweep::submit_round() {
  std::vector<std::uint64_t> missing;
  for (std::uint64_t shard = 0; shard < sweep_.shards; ++shard) {
    if (names_.count(fmt::format("shard_{}.db", shard)) == 0) missing.push_back(shard);
  }
  if (!jobs_.empty()) end_round(missing);
  Words behind;
  if (!missing.empty()) {
    const std::string job =
        submit("task.sh", "shard_%a.log", {"--array=" + files::ranges_text(missing, ",")});
    progress_.waiting += missing.size();
    say_(fmt::format("job {}: {} of {}", job, shards_text(missing), sweep_.shards));
    behind = {"--dependency=afterany:" + job};
  }
  say_(fmt::format("job {}: the merge into {}", submit("merge.sh", kMergeLog, behind), store_));
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

std::string SlurmSweep::submit(const std::string& script, const std::string& log, const Words& options) {
  Words words = {"sbatch"};
  for (const std::string& option : options_) words.push_back("--" + option);
  // In paths of logs sbatch replaces %a and the like.
  const std::string folder = std::regex_replace(folder_, std::regex("%"), "%%");
  words.insert(words.end(),
               {"--job-name=" + name_, "--open-mode=append", fmt::format("--output={}/{}", folder, log)});
  words.insert(words.end(), options.begin(), options.end());
  words.insert(words.end(), {"--parsable", file(script), fs::read_symlink("/proc/self/exe").string(), folder_,
                             std::to_string(sweep_.shards), store_});
  const std::string said = run(words);  // "12", or "12;cluster"
  const std::string job = said.substr(0, said.find_first_of(";\n"));
  if (!is_number(job)) throw SlurmError(fmt::format("sbatch: no job number in its output: {}", job));
  live_jobs_.insert(job);
  jobs_.insert(job);
  return job;
}

void SlurmSweep::cancel() {
  try {
    cancel_in_slurm(live_jobs_);
    for (const auto end = Clock::now() + kCancelTimeout; !live_jobs_.empty(); refresh()) {
      if (Clock::now() > end)
        return say_(fmt::format("the jobs have not ended yet; their finished points are in {}", folder_));
      std::this_thread::sleep_for(1s);
    }
  } catch (const SlurmError& error) {
    throw SlurmError(fmt::format("{}; {}", error.what(), kJobsContinue));
  }
  keep_points();
  remove();
}

void SlurmSweep::give_up(const std::vector<std::uint64_t>& missing) const {
  const bool is_merge = missing.empty();
  const std::string what = is_merge ? "the merge" : fmt::format("shard {}", missing.front());
  const std::string log = file(is_merge ? kMergeLog : fmt::format("shard_{}.log", missing.front()));
  const Words lines = split(text_of(log), '\n');
  throw std::runtime_error(fmt::format(
      "{} has been lost {} times without a further point ({}); {}; finished points are kept in {}: run the "
      "same command to resume",
      what, kMostLosses, end_of(is_merge ? std::nullopt : std::optional(missing.front())),
      fs::exists(log) ? fmt::format("its log {} ends with: {}", log, lines.empty() ? "" : lines.back())
                      : fmt::format("there is no {}: the nodes must share this folder", log),
      folder_));
}

}  // namespace stereotlm::explore
