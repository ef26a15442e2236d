#pragma once

#include <string>

#include "models/fpga/conflict_recorder.h"
#include "platform/config/board_config.h"

namespace stereotlm::report {

// Cycles and accesses of each strip of results, the fill first, summed over frames.
class StripSums {
 public:
  void add(const fpga::FrameConflicts& frame);
  const fpga::FrameConflicts& sums() const { return sums_; }

 private:
  fpga::FrameConflicts sums_;
};

// What `conflicts` prints: who waits where for whom, and where in the picture; how busy the banks are from top
// to bottom.
std::string conflicts_text(const platform::BoardConfig& board, const fpga::ConflictRecorder& recorder,
                           const fpga::FrameConflicts& sums);

}  // namespace stereotlm::report
