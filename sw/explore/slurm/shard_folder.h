#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "sw/explore/sweep/sweep_counts.h"

namespace stereotlm::explore {

// What the tasks of a sweep on several machines are given.
struct ShardedSweep {
  std::string plan;                  // the text of its file
  std::optional<std::string> board;  // that of the board file that it names; nothing: it names a preset
  struct Calibration {
    std::string file;
    std::string left_lut;
    std::string right_lut;
  };
  std::optional<Calibration> calibration;  // the bytes of its files; nothing: tables are the identity
  std::vector<std::string> banks;          // of all points
  std::string version;                     // of the program
  std::uint64_t points = 0;
  std::uint64_t shards = 1;

  std::uint64_t points_of(std::uint64_t shard) const;
};

// The folder STORE.shards, on a file system that all machines share. There lie copies of the plan, of its
// board and of its calibration, the scripts of the tasks, and for each shard its store, its counts and its
// log: some files a shard, none a point. A shard is whole when shard_I.db is there. Member functions throw
// std::runtime_error that names the file.
class ShardFolder {
 public:
  explicit ShardFolder(const std::string& store);  // does not touch it
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
  // Makes it if it is not there, and keeps other processes out until this object or the process ends.
  void lock();
  // Whether it is there for this sweep and not for another.
  bool is_of(const ShardedSweep& sweep) const;
  // Puts the points of all shards, whole or not, into the store. Nobody may write to them.
  void keep_points(const std::string& version);
  // Leaves in it what the tasks of this sweep need, and nothing else; and gives the store, if it is there,
  // the form in which many may read it.
  void begin(const ShardedSweep& sweep);
  void remove();

  bool is_whole(std::uint64_t shard) const;
  bool is_merged() const;  // the last task has put all shards into the store
  // As the shard's task has last said it: `total` 0 if it has said nothing yet.
  SweepCounts counts(std::uint64_t shard) const;
  // What a log says at its end; empty if it is not there.
  static std::string last_line(const std::string& log);

  // Looks what is there: is_whole() and is_merged() are as of the last look.
  void look();

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
