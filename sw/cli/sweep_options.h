#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sw/cli/options.h"
#include "sw/explore/sweep/sweep.h"
#include "sw/files/output_file.h"

namespace stereotlm::cli {

// The options of `sweep`.
class SweepCommandOptions : public Options {
 public:
  using Options::Options;

  void check_together(process::Problems& problems) override;

  explore::SweepOptions sweep() const;
  bool is_slurm() const { return launcher.text() == "slurm"; }
  std::uint64_t tasks() const;                      // of the job array
  std::vector<std::string> sbatch_options() const;  // with their dashes
  // The file of --progress, for one write.
  files::OutputFile progress_file() const;

  Option plan = Option(this, "PLAN", " ", "The plan's file", {required("the path of a plan")});
  Option out = Option(this, "--out", "DB", "The database to write, or to continue",
                      {required("the database to write, or to continue")});
  Option jobs = Option(this, "--jobs", "N", "Worker processes; default: the processors of this machine",
                       {is_within<unsigned>(kMostJobs)});
  Option shard =
      Option(this, "--shard", "I/N",
             "Only every N-th point, from number I on (0 .. N-1); see stereotlm merge", {is_shard()});
  Option board = Option(this, "--board", "BOARD", "In place of the board that the plan names", {not_empty});
  Option calibration =
      Option(this, "--calibration", "F", "In place of the calibration that the plan names", {not_empty});
  Option known =
      Option(this, "--known", "DB2", "A database, only read, whose points are not run either", {not_empty});
  Option progress =
      Option(this, "--progress", "F", "Keep in this file how many points are done", {not_empty});
  Option launcher = Option(this, "--launcher", "WHERE", "Where it runs: local, the default, or slurm",
                           {one_of({"local", "slurm"})});
  Option shards = Option(this, "--shards", "N", "With slurm: the tasks of the job array (default 16)",
                         {is_within<std::uint64_t>(kMostShards)});
  Option sbatch =
      Option(this, "--sbatch", "NAME=VALUE",
             "With slurm: an option of sbatch for all jobs, such as partition=long or time=8:00:00; again "
             "for further ones",
             {}, Takes::kRepeated);

 private:
  static constexpr std::uint64_t kMostJobs = 1024;
  static constexpr std::uint64_t kMostShards = 1000;
  static constexpr std::uint64_t kDefaultShards = 16;

  template <typename Number>
  static Rule is_within(std::uint64_t most) {
    return number<Number>("1.." + std::to_string(most),
                          [most](Number count) { return count >= 1 && count <= most; });
  }
  static Rule is_shard();
  static void not_empty(const Option& option, process::Problems& problems);
};

}  // namespace stereotlm::cli
