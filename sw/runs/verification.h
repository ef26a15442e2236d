#pragma once

#include <optional>
#include <string>
#include <vector>

#include "platform/figures/statistics.h"
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

  // Waits for the other run and compares. Returns the differences, or the failure of the other run; nothing
  // is in the list if all is equal. The first interrupt ends the wait: nullopt.
  std::optional<std::vector<std::string>> compare(const platform::Statistics& statistics);

 private:
  std::optional<std::string> next_of_other(ProgressLine& progress, std::size_t frames_compared);

  const RunInput& input_;
  std::vector<std::string> results_;  // one line per frame, in order
  process::Child other_;
};

}  // namespace stereotlm::runs
