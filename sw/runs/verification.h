#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "platform/statistics.h"
#include "sw/process/child.h"
#include "sw/runs/progress.h"
#include "sw/runs/run_input.h"
#include "sw/runs/simulation/simulation.h"
#include "sw/runs/sources/picture_source.h"

namespace stereotlm::runs {

// `--verify`: the same run at the other fidelity, in a process of its own, and what differs.
class Verification {
 public:
  // Begins the other run; before this process elaborates its own. It opens the pictures anew. `input`
  // and `pictures` outlive it.
  Verification(const RunInput& input, const PictureSource& pictures);

  // A result of this process's run, in turn.
  void add(const Result& result);

  struct Outcome {
    bool interrupted = false;  // nothing is compared
    std::vector<std::string>
        failed;  // what is not the same, or became of the other run; empty: all is the same
  };
  // Waits for the other run, until the first interrupt, and compares.
  Outcome compare(const platform::Statistics& statistics);

 private:
  std::optional<std::string> next_of_other(ProgressLine& progress, std::size_t frames_compared);

  const RunInput& input_;
  std::vector<std::string> results_;  // one line each, in the order of the frames
  std::unique_ptr<process::Child> other_;
};

}  // namespace stereotlm::runs
