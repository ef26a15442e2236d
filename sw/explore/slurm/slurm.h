#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace stereotlm::explore {

// A command of Slurm failed. what() has Slurm's message.
class SlurmError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// A job, or one task of a job array, as squeue lists it.
struct SlurmTask {
  std::string job;                     // number of the job, or of the job array
  std::optional<std::uint64_t> index;  // of a task in its job array
  std::string state;                   // "PENDING", "RUNNING", "NODE_FAIL", ..
  std::string reason;                  // why it waits: "Resources", ..

  bool is_live() const;  // whether it waits, runs, or still has processes
};

// The jobs with this name, including those that ended in the last minutes. Throws SlurmError.
std::vector<SlurmTask> slurm_jobs(const std::string& name);

// Submits the shell script `script` with these arguments, and returns the number of the job. `options`: for
// sbatch; if an option is repeated, its last value counts. Throws SlurmError.
std::string submit_to_slurm(const std::vector<std::string>& options, const std::string& script,
                            const std::vector<std::string>& arguments);

// Cancels jobs, given by their numbers. Throws SlurmError.
void cancel_in_slurm(const std::vector<std::string>& jobs);

// The value of sbatch's option --array for these indices of tasks, such as "0,3,5-9". `numbers` must be
// ascending.
std::string array_text(const std::vector<std::uint64_t>& numbers);

}  // namespace stereotlm::explore
