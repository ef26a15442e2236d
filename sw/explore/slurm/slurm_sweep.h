#pragma once

#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "sw/explore/slurm/shard_folder.h"
#include "sw/explore/slurm/slurm.h"
#include "sw/explore/sweep/sweep_counts.h"

namespace stereotlm::explore {

// How far the jobs of a sweep are.
struct SlurmProgress {
  SweepCounts counts;
  std::uint64_t running = 0;  // shards
  std::uint64_t waiting = 0;
  std::string reason;  // for which the first of them waits, in Slurm's word; empty: not known
};

// A sweep whose shards are the tasks of a job array of Slurm, and whose last job merges them into the store.
// The jobs do not need this process: it shows how far they are and submits again what is lost. Started anew
// it finds them by their name.
class SlurmSweep {
 public:
  using Say = std::function<void(const std::string& note)>;

  // `options`: of sbatch, for all jobs, such as --partition=long. `say` is given what is worth a line.
  SlurmSweep(const ShardedSweep& sweep, const std::string& store, const std::vector<std::string>& options,
             Say say);

  // Submits the jobs, or finds them. Throws SlurmError, DatabaseError, std::runtime_error: then nothing has
  // been submitted, and nothing is left behind.
  void begin();

  // Waits until all points are in the store; the folder of the shards is gone then. `keep_going` is called
  // several times a second; once it returns false the jobs are cancelled, and what they have done is put into
  // the store. Throws SlurmError, DatabaseError, std::runtime_error, among others if a shard is lost again
  // and again; what is done is kept in the folder.
  SweepCounts wait(const std::function<bool(const SlurmProgress&)>& keep_going);

 private:
  // A shard's task, or the merge.
  struct Work {
    std::string job;       // of Slurm, as this object has last seen or submitted it
    bool is_live = false;  // in Slurm's hands
    bool is_given_up = false;
    int losses = 0;               // in a row, without a further point
    std::uint64_t most_done = 0;  // points, when it was lost
    std::string end;              // of its job, in Slurm's word; empty: not known
  };

  void look();
  void look_at(const SlurmTask& task);
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
  std::string name_;  // of all jobs
  std::vector<Work> shards_;
  std::vector<std::uint64_t> done_;  // points of each shard
  Work merge_;
  std::set<std::string> live_jobs_;
  SlurmProgress progress_;
};

}  // namespace stereotlm::explore
