#pragma once

#include <cstdint>
#include <stdexcept>
#include <systemc>

// The simulated time of the SystemC kernel, in ps.
namespace stereotlm::kernel_time {

// At a resolution of 1 ps.
inline sc_core::sc_time to_time(std::uint64_t ps) { return sc_core::sc_time::from_value(ps); }
inline std::uint64_t to_ps(const sc_core::sc_time& time) { return time.value(); }
inline std::uint64_t now_ps() { return to_ps(sc_core::sc_time_stamp()); }  // sc_time_stamp() in ps

// Throws std::invalid_argument unless the kernel's time resolution is 1 ps, its default. The conversions
// above need it.
inline void check_resolution() {
  if (sc_core::sc_get_time_resolution() != sc_core::sc_time(1, sc_core::SC_PS)) {
    throw std::invalid_argument("time resolution = " + sc_core::sc_get_time_resolution().to_string() +
                                ": must be 1 ps");
  }
}

}  // namespace stereotlm::kernel_time
