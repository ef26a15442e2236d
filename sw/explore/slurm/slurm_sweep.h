#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "sw/explore/slurm/shard_folder.h"
#include "sw/explore/slurm/slurm.h"
#include "sw/explore/sweep/sweep.h"

namespace stereotlm::explore {

// The progress of the jobs of a sweep.
struct SlurmProgress {
  SweepCounts counts;
  std::uint64_t running = 0;  // shards
  std::uint64_t waiting = 0;  // shards
  std::string reason;         // why the first waiting shard waits, in Slurm's words; empty: not known
};

// A sweep on a cluster, in rounds. A round is a job array of Slurm, one task for each shard that is not
// whole, and behind it a job that merges all shards into the store. Once all jobs of a round have ended, and
// shards were lost, the next round begins. This process reports the progress. If it ends, the jobs of its
// round continue, and a new process finds them by their name.
class SlurmSweep {
 public:
  using Say = std::function<void(const std::string& note)>;

  // `options` are passed to sbatch for all jobs, such as --partition=long. `say` is called with notes for the
  // user.
  SlurmSweep(const ShardedSweep& sweep, const std::string& store, const std::vector<std::string>& options,
             Say say);

  // Submits the jobs, or finds those of an earlier process. Throws SlurmError, DatabaseError, or
  // std::runtime_error. After an exception no new job and no new folder is left.
  void begin();

  // Waits until all points are in the store, and removes the folder of the shards. `keep_going` is called
  // several times a second. Once it returns false, the jobs are cancelled, and their finished points are
  // merged into the store. Throws SlurmError, DatabaseError, or std::runtime_error; the last also if
  // rounds end repeatedly without a further point. After an exception the finished points stay in the folder.
  SweepCounts wait(const std::function<bool(const SlurmProgress&)>& keep_going);

 private:
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
  ShardFolder folder_;
  std::string name_;                 // of the jobs
  std::set<std::string> live_jobs_;  // numbers
  // Of the round that was submitted or found last: the numbers of its jobs, and how its tasks and its merge
  // have ended.
  std::set<std::string> jobs_;
  std::map<std::optional<std::uint64_t>, std::string> ends_;  // [shard]; nullopt: the merge
  int losses_ = 0;                                            // successive rounds without a further point
  std::uint64_t most_done_ = 0;                               // points that were done at the end of a round
  SlurmProgress progress_;
};

}  // namespace stereotlm::explore
