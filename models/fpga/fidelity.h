#pragma once

#include <cstdint>

namespace stereotlm::fpga {

// How the core works on a frame. Results and times are the same at all of them.
enum class Fidelity : std::uint8_t {
  kCycle,   // cycle by cycle, every access a transaction
  kFast,    // its data at once, by direct access; its cycles ahead (FastForward)
  kTiming,  // as kFast, but without pictures and disparities; a frame that is stepped has both
};

}  // namespace stereotlm::fpga
