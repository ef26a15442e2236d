#pragma once

#include <cstdint>

namespace stereotlm {

// A time in ps that never comes. Times are whole picoseconds from the beginning of the simulation.
inline constexpr std::uint64_t kNever = UINT64_MAX;

}  // namespace stereotlm
