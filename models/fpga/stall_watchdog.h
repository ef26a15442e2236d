#pragma once

#include <cstdint>
#include <string>

#include "models/fpga/core_control.h"
#include "models/memory/arbitration.h"

namespace stereotlm::fpga {

// Finds frames that make no progress: the matcher does not work and no result is written, because the
// arbiters never grant one of the core's ports. Plain C++.
class StallWatchdog {
 public:
  explicit StallWatchdog(std::uint64_t timeout_cycles) : timeout_cycles_(timeout_cycles) {}

  // To be called when a frame starts in `cycle`. `work`: CoreControl::work().
  void start_frame(std::uint64_t cycle, std::uint64_t work) {
    work_ = work;
    work_cycle_ = cycle;
  }
  // To be called regularly while a frame runs; a stall is found in the first call that is late enough.
  // Returns the number of cycles without progress if it has reached the timeout, else 0. After a timeout it
  // is counted anew.
  std::uint64_t stalled_cycles(std::uint64_t cycle, std::uint64_t work);

 private:
  std::uint64_t timeout_cycles_;
  std::uint64_t work_ = 0;        // `work` of the last call
  std::uint64_t work_cycle_ = 0;  // cycle of the last call that found progress, or of the last timeout
};

// Text for messages: what each port does in the next cycle of a frame. For a port that requests a bank, the
// text also names the port to which it has lost that bank most often.
std::string waits_of_ports(const CoreControl& control, const memory::Arbitration& arbitration,
                           bool host_requests);

}  // namespace stereotlm::fpga
