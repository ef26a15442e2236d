#pragma once

#include <cstdint>

namespace stereotlm::fpga {

// How the core works on a frame; the results and times are the same.
enum class Fidelity : std::uint8_t {
  kCycle,   // cycle by cycle, every access a transaction
  kFast,    // its data at once, by direct access; its timing ahead, as far as it is known (CoreTiming)
  kTiming,  // as kFast, but without pictures and disparities; a frame done cycle by cycle has both
};

}  // namespace stereotlm::fpga
