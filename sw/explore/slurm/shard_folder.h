#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "sw/explore/sweep/sweep.h"

namespace stereotlm::explore {

// The data that the tasks of a sweep on several machines need.
struct ShardedSweep {
  std::string plan;                  // contents of the plan file
  std::optional<std::string> board;  // contents of the plan's board file; nullopt: the plan names a preset
  struct Calibration {
    std::string file;
    std::string left_lut;
    std::string right_lut;
  };
  std::optional<Calibration> calibration;  // contents of its files; nullopt: tables are the identity
  std::vector<std::string> banks;          // names of the banks of all points
  std::string version;                     // of the program
  std::uint64_t points = 0;
  std::uint64_t shards = 1;
};

// The folder STORE.shards, on a file system that all machines share. It holds copies of the plan, its board
// and its calibration, the scripts of the tasks, and the store, the counts and the log of each shard: some
// files for each shard, none for each point. A shard is whole (all of its points are done) once shard_I.db
// exists. Member functions throw std::runtime_error that names the file.
class ShardFolder {
 public:
  explicit ShardFolder(const std::string& store);  // neither makes nor changes the folder
  ~ShardFolder();
  ShardFolder(const ShardFolder&) = delete;
  ShardFolder& operator=(const ShardFolder&) = delete;

  const std::string& store() const { return store_; }  // absolute
  const std::string& path() const { return path_; }    // absolute
  std::string task_script() const { return file("task.sh"); }
  std::string merge_script() const { return file("merge.sh"); }
  static std::string task_log(const std::string& shard) { return "shard_" + shard + ".log"; }
  static constexpr const char* kMergeLog = "merge.log";

  bool exists() const;
  // Makes the folder if there is none, and locks it. The lock is released when this object is destroyed or
  // the process ends.
  void lock();
  // Whether the folder exists and belongs to this sweep.
  bool is_of(const ShardedSweep& sweep) const;
  // Merges the points of all shards, whole or not, into the store. No other process may write to the shards
  // meanwhile.
  void keep_points(const std::string& version);
  // Replaces the contents of the folder by the files that the tasks of this sweep need. If the store exists,
  // merge_stores() rewrites it, so that many processes can read it at the same time.
  void begin(const ShardedSweep& sweep);
  void remove();

  bool is_whole(std::uint64_t shard) const;
  bool is_merged() const;  // whether the last job has merged all shards into the store
  // The last counts that the task of the shard has written; all 0 if it has written none yet.
  SweepCounts counts(std::uint64_t shard) const;
  // The last line of a log; empty if there is no log.
  static std::string last_line(const std::string& log);

  // Lists the names in the folder. is_whole() and is_merged() use the last list.
  void refresh();

 private:
  std::string file(const std::string& name) const { return path_ + '/' + name; }
  bool has(const std::string& name) const;
  void empty() const;

  std::string store_;
  std::string path_;
  int lock_ = -1;
  std::set<std::string> names_;
};

}  // namespace stereotlm::explore
