#pragma once

#include <cstdint>

namespace stereotlm::fpga {

// A burst on the local bus. Each time is that at which a clock of the bus begins.
struct EndedLocalBurst {
  bool write = false;
  std::uint64_t address = 0;  // on the local bus
  std::uint64_t words = 0;
  std::uint64_t address_ps = 0;  // the address clock
  std::uint64_t data_ps = 0;     // the decode clock
  std::uint64_t end_ps = 0;      // the idle clock
  std::uint64_t free_ps = 0;     // the clock after the idle clock
};

// Receives the bursts of the local bus, for traces. Plain C++.
class LocalBusObserver {
 public:
  virtual ~LocalBusObserver() = default;
  // Called once for each burst, in their order, as soon as its end is known. That is at free_ps or earlier. A
  // burst that was refused is none.
  virtual void local_burst_ended(const EndedLocalBurst& burst) = 0;
};

}  // namespace stereotlm::fpga
