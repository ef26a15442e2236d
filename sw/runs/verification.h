#pragma once

#include <optional>
#include <string>
#include <vector>

#include "platform/statistics.h"
#include "sw/process/child.h"
#include "sw/runs/progress.h"
#include "sw/runs/run_input.h"
#include "sw/runs/simulation/simulation.h"

namespace stereotlm::runs {

// `--verify`: repeats a run at the other fidelity in a child process and compares the two.
class Verification {
 public:
  // Starts the other run. To be called before this process elaborates its own simulation. The child opens the
  // pictures itself. `input` outlives the object.
  explicit Verification(const RunInput& input);

  // Adds the next result of this process's run.
  void add(const Result& result);

  // The result of the comparison.
  struct Outcome {
    bool interrupted = false;         // nothing was compared
    std::vector<std::string> failed;  // differences, or the failure of the other run; empty if all is equal
  };
  // Waits for the other run and compares. The first interrupt ends the wait.
  Outcome compare(const platform::Statistics& statistics);

 private:
  std::optional<std::string> next_of_other(ProgressLine& progress, std::size_t frames_compared);

  const RunInput& input_;
  std::vector<std::string> results_;  // one line per frame, in order
  process::Child other_;
};

}  // namespace stereotlm::runs
