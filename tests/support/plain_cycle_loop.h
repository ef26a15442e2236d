#pragma once

#include <cstdint>

#include "tests/support/plain_core.h"
#include "tests/support/plain_cycle_input.h"

// The frames of `--source preloaded`: each begins in the cycle after the end of the one before.
namespace stereotlm::test {

inline constexpr std::uint64_t kPlainMaxFrameCycles = 50'000'000;

// Runs `frames` frames, 1 or more. A frame whose last write is not granted within its first max_frame_cycles
// cycles is a hang.
PlainCycleResult run_plain_cycle_loop(const PlainCycleInput& input, int frames,
                                      std::uint64_t max_frame_cycles = kPlainMaxFrameCycles);

}  // namespace stereotlm::test
