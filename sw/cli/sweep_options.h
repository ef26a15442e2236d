#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sw/cli/typed_option.h"
#include "sw/explore/sweep/sweep.h"
#include "sw/files/output_file.h"
#include "sw/process/problems.h"

namespace CLI {
class App;
}

namespace stereotlm::cli {

// Parses and checks the options of `sweep`.
class SweepCommandOptions {
 public:
  // Adds the options to the command, before parsing.
  void add_to(CLI::App& command);

  // To be called in the command's callback: throws Refused if options are wrong.
  void check_usage();

  // The file of --progress, for one write.
  files::OutputFile progress_file() const;

  // The values of these options, as typed.
  Typed plan;
  Typed shard;
  Typed board;
  Typed calibration;
  Typed progress;

  // Set by check_usage().
  explore::SweepOptions sweep;
  bool is_slurm = false;
  std::uint64_t shards = 0;                 // tasks of the job array
  std::vector<std::string> sbatch_options;  // with their dashes

 private:
  void check_jobs(process::Problems& problems);
  void check_shard(process::Problems& problems);
  void check_launcher(process::Problems& problems);
  void check_progress(process::Problems& problems) const;

  Typed out_;
  Typed jobs_;
  Typed known_;
  Typed launcher_;
  Typed shards_;
  TypedList sbatch_;
};

}  // namespace stereotlm::cli
