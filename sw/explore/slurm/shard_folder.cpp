#include "sw/explore/slurm/shard_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <system_error>
#include <vector>

#include "sw/explore/store/store.h"
#include "sw/explore/store/store_lock.h"
#include "sw/files/sha256.h"
#include "sw/files/whole_file.h"

namespace stereotlm::explore {
namespace {

namespace fs = std::filesystem;

constexpr const char* kEnding = ".shards";
constexpr const char* kLock = "lock";
constexpr const char* kSweep = "sweep";
constexpr const char* kPlan = "plan.yaml";
constexpr const char* kBoard = "board.yaml";
constexpr const char* kCalibration = "calibration.yaml";
constexpr const char* kLeftLut = "calibration_left.lut";
constexpr const char* kRightLut = "calibration_right.lut";
constexpr const char* kMerged = "merged";

// Both scripts are called with PROGRAM FOLDER SHARDS STORE.
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

std::string sha(const std::string& text) { return files::sha256_hex(text.data(), text.size()); }

// A text that is different for each sweep.
std::string identity(const ShardedSweep& sweep) {
  const auto& calibration = sweep.calibration;
  const std::string tables = calibration
                                 ? fmt::format("{} {} {}", sha(calibration->file), sha(calibration->left_lut),
                                               sha(calibration->right_lut))
                                 : "none";
  return fmt::format("version {}\nshards {}\nplan {}\nboard {}\ncalibration {}\n", sweep.version,
                     sweep.shards, sha(sweep.plan), sweep.board ? sha(*sweep.board) : "preset", tables);
}

std::string shard_file(std::uint64_t shard, const char* ending) {
  return fmt::format("shard_{}{}", shard, ending);
}

// The contents of a file; empty if it does not exist.
std::string text_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

ShardFolder::ShardFolder(const std::string& store)
    : store_(fs::weakly_canonical(fs::absolute(behind_links(store))).string()), path_(store_ + kEnding) {}

ShardFolder::~ShardFolder() {
  if (lock_ >= 0) close(lock_);
}

bool ShardFolder::exists() const { return fs::exists(path_); }

void ShardFolder::lock() {
  std::error_code error;
  fs::create_directory(path_, error);
  if (error) throw std::runtime_error(fmt::format("{}: cannot be made: {}", path_, error.message()));
  const std::string path = file(kLock);
  if (!fs::is_empty(path_) && !fs::exists(path)) {
    throw std::runtime_error(path_ +
                             ": exists, and is not a folder of shards: remove it, or give another --out");
  }
  lock_ = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (lock_ < 0) throw std::system_error(errno, std::generic_category(), path);
  if (flock(lock_, LOCK_EX | LOCK_NB) == 0) return;
  if (errno != EWOULDBLOCK) throw std::system_error(errno, std::generic_category(), path);
  throw std::runtime_error(path_ + ": another process waits for these shards already");
}

bool ShardFolder::is_of(const ShardedSweep& sweep) const { return text_of(file(kSweep)) == identity(sweep); }

void ShardFolder::keep_points(const std::string& version) {
  std::vector<std::string> stores;
  for (const auto& entry : fs::directory_iterator(path_)) {
    const fs::path ending = entry.path().extension();
    if (ending == ".work" || ending == ".db") stores.push_back(entry.path().string());
  }
  if (stores.empty()) return;
  for (const std::string& path : stores) {
    if (fs::path(path).extension() != ".work") continue;
    const Store completed(path, version);
  }
  const StoreLock lock(store_);
  if (fs::file_size(store_) > 0) stores.push_back(store_);
  merge_stores(stores, store_);
}

void ShardFolder::empty() const {
  for (const auto& entry : fs::directory_iterator(path_)) {
    if (entry.path().filename() != kLock) fs::remove_all(entry.path());
  }
}

void ShardFolder::begin(const ShardedSweep& sweep) {
  if (fs::exists(store_)) {
    const StoreLock lock(store_);
    Store(store_, sweep.version).check_banks(sweep.banks);
    merge_stores({store_}, store_);
  }
  empty();
  files::write_whole_file(file(kPlan), sweep.plan);
  if (sweep.board) files::write_whole_file(file(kBoard), *sweep.board);
  if (sweep.calibration) {
    files::write_whole_file(file(kCalibration), sweep.calibration->file);
    files::write_whole_file(file(kLeftLut), sweep.calibration->left_lut);
    files::write_whole_file(file(kRightLut), sweep.calibration->right_lut);
  }
  files::write_whole_file(task_script(), kTaskScript);
  files::write_whole_file(merge_script(), kMergeScript);
  files::write_whole_file(file(kSweep), identity(sweep));
}

void ShardFolder::remove() {
  empty();
  fs::remove_all(path_);
}

// On NFS a query for a single name may fail for a minute after the file was made; the list of a folder is
// current.
void ShardFolder::refresh() {
  names_.clear();
  for (const auto& entry : fs::directory_iterator(path_)) names_.insert(entry.path().filename().string());
}

bool ShardFolder::has(const std::string& name) const { return names_.count(name) > 0; }

bool ShardFolder::is_whole(std::uint64_t shard) const { return has(shard_file(shard, ".db")); }

bool ShardFolder::is_merged() const { return has(kMerged) && fs::exists(store_); }

SweepCounts ShardFolder::counts(std::uint64_t shard) const {
  return read_counts(text_of(file(shard_file(shard, ".progress"))));
}

std::string ShardFolder::last_line(const std::string& log) {
  std::string text = text_of(log);
  while (!text.empty() && text.back() == '\n') text.pop_back();
  const std::size_t line = text.rfind('\n');
  return line == std::string::npos ? text : text.substr(line + 1);
}

}  // namespace stereotlm::explore
