#pragma once

#include <cstdint>
#include <functional>
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

// A sweep on a cluster: its shards are the tasks of a job array of Slurm, and its last job merges them into
// the store. This process reports the progress, and submits lost work again. If it ends, the jobs continue,
// and a new process finds them by their name.
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
  // merged into the store. Throws SlurmError, DatabaseError, or std::runtime_error; the last also if a shard
  // is lost repeatedly. After an exception the finished points stay in the folder.
  SweepCounts wait(const std::function<bool(const SlurmProgress&)>& keep_going);

 private:
  // The task of a shard, or the merge.
  struct Work {
    std::string job;       // number of the job that was listed or submitted last; empty: none
    bool is_live = false;  // the job waits or runs
    bool is_given_up = false;
    int losses = 0;               // successive losses without a further point
    std::uint64_t most_done = 0;  // largest number of points that were done at a loss
    std::string end;              // Slurm's state of the ended job; empty: not known
  };

  void refresh();
  void take(const SlurmTask& task);
  void submit_missing();
  void submit_shards(const std::vector<std::uint64_t>& shards);
  void submit_merge();
  std::string submit(const std::string& script, const std::string& log,
                     const std::vector<std::string>& options);
  bool may_continue(Work& work, std::uint64_t done) const;
  void cancel();
  [[noreturn]] void give_up() const;

  ShardedSweep sweep_;
  std::vector<std::string> options_;
  Say say_;
  ShardFolder folder_;
  std::string name_;                 // of the jobs
  std::vector<Work> shards_;         // [shard]
  std::vector<std::uint64_t> done_;  // [shard]: number of points that are done
  Work merge_;
  std::set<std::string> live_jobs_;  // numbers
  SlurmProgress progress_;
};

}  // namespace stereotlm::explore
