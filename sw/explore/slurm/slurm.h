#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "sw/explore/sweep/sweep.h"

namespace stereotlm::explore {

// A command of Slurm failed. what() has Slurm's message.
class SlurmError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// What the tasks of a sweep on several machines need.
struct ShardedSweep {
  // Contents of the files: "plan.yaml"; "board.yaml", unless the plan names a preset; "calibration.yaml" and
  // its tables, unless these are the identity.
  std::map<std::string, std::string> files;
  std::vector<std::string> banks;  // names of the banks of all points
  std::string version;             // of the program
  std::uint64_t points = 0;
  std::uint64_t shards = 1;
};

// The progress of the jobs of a sweep.
struct SlurmProgress {
  SweepCounts counts;
  std::uint64_t running = 0;  // shards
  std::uint64_t waiting = 0;  // shards
  std::string reason;         // why the first waiting shard waits, in Slurm's words; empty: not known
};

// A sweep on a cluster, in rounds. A shard is whole (all of its points are done) once shard_I.db exists. A
// round is a job array of Slurm, with a task for each shard that is not whole, and behind it a job that
// merges all shards into the store. If all jobs of a round have ended without a merged store, the next round
// begins. This process reports the progress. If it ends, the jobs of its round continue, and a new process
// finds them by their name.
//
// The folder STORE.shards is on a file system that all machines share. It holds the files of the sweep, the
// scripts of the tasks, and the store, counts and log of each shard; no file per point.
class SlurmSweep {
 public:
  using Say = std::function<void(const std::string& note)>;

  // `options`: of sbatch, for all jobs, such as partition=long. `say` is called with notes for the user.
  SlurmSweep(const ShardedSweep& sweep, const std::vector<std::string>& options, Say say)
      : sweep_(sweep), options_(options), say_(std::move(say)) {}
  ~SlurmSweep();
  SlurmSweep(const SlurmSweep&) = delete;
  SlurmSweep& operator=(const SlurmSweep&) = delete;

  // Submits the jobs, or finds those of an earlier process. Throws SlurmError, DatabaseError, or
  // std::runtime_error. After an exception no new job and no new folder is left.
  void begin(const std::string& store);

  // Waits until all points are in the store, and removes the folder of the shards. `keep_going` is called
  // several times a second. Once it returns false, the jobs are cancelled, and their finished points are
  // merged into the store. Throws SlurmError, DatabaseError, or std::runtime_error; the last also if
  // rounds end repeatedly without a further point. After an exception the finished points stay in the folder.
  SweepCounts wait(const std::function<bool(const SlurmProgress&)>& keep_going);

 private:
  std::string file(const std::string& name) const { return folder_ + '/' + name; }
  bool is_merged() const;
  bool is_of_this_sweep() const;
  void lock();
  void keep_points() const;
  void empty() const;
  void remove() const;
  void fill() const;
  void refresh();
  void submit_round();
  void end_round(const std::vector<std::uint64_t>& missing);
  std::string submit(const std::string& script, const std::string& log,
                     const std::vector<std::string>& options);
  void cancel();
  [[noreturn]] void give_up(const std::vector<std::uint64_t>& missing) const;
  // Slurm's state of the ended task of a shard, or of the merge, for a message.
  std::string end_of(std::optional<std::uint64_t> shard) const;

  ShardedSweep sweep_;
  std::vector<std::string> options_;
  Say say_;
  std::string store_;   // absolute
  std::string folder_;  // absolute
  int lock_ = -1;
  std::string name_;                 // of the jobs
  std::set<std::string> names_;      // in the folder
  std::set<std::string> live_jobs_;  // numbers
  // The numbers of the jobs of the latest round, and how its tasks and its merge have ended.
  std::set<std::string> jobs_;
  std::map<std::optional<std::uint64_t>, std::string> ends_;  // [shard]; nullopt: the merge
  int losses_ = 0;                                            // successive rounds without a further point
  std::uint64_t most_done_ = 0;                               // points that were done at the end of a round
  SlurmProgress progress_;
};

}  // namespace stereotlm::explore
