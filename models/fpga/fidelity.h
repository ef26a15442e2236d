#pragma once

#include <cstdint>

namespace stereotlm::fpga {

// How the core simulates a frame. Results and times are the same at every fidelity.
enum class Fidelity : std::uint8_t {
  kCycle,   // cycle by cycle, every access a transaction
  kFast,    // data in one step, by direct access; cycles fast-forwarded (FastForward)
  kTiming,  // as kFast, but without pictures and disparities; a frame that is stepped has both
};

}  // namespace stereotlm::fpga
