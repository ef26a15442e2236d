#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace stereotlm::explore {

// What Slurm could not do, in its own words.
class SlurmError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// A job, or one task of a job array, as squeue lists it.
struct SlurmTask {
  std::string job;                     // its number; of a task that of the array
  std::optional<std::uint64_t> index;  // of a task
  std::string state;                   // "PENDING", "RUNNING", "NODE_FAIL", ..
  std::string reason;                  // for which it waits: "Resources", ..

  bool is_live() const;  // it waits, runs, or still has processes
};

// The jobs of that name, also those that have ended in the last minutes. Throws SlurmError.
std::vector<SlurmTask> slurm_jobs(const std::string& name);

// As squeue prints it with the format that slurm_jobs() asks for. Throws SlurmError.
std::vector<SlurmTask> read_squeue(const std::string& text);

// Submits the shell script `script`, which gets `arguments`, with options of sbatch; those further behind
// overrule. Returns the number of the job. Throws SlurmError.
std::string submit_to_slurm(const std::vector<std::string>& options, const std::string& script,
                            const std::vector<std::string>& arguments);

// Ends jobs, given by their numbers. Throws SlurmError.
void cancel_in_slurm(const std::vector<std::string>& jobs);

// As the option --array has it: "0,3,5-9". The numbers ascend.
std::string array_text(const std::vector<std::uint64_t>& numbers);

}  // namespace stereotlm::explore
