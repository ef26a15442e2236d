#pragma once

#include <algorithm>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <systemc>

// The simulated time of the SystemC kernel, in ps.
namespace stereotlm::kernel_time {

// At a resolution of 1 ps.
inline sc_core::sc_time to_time(std::uint64_t ps) { return sc_core::sc_time::from_value(ps); }
inline std::uint64_t to_ps(const sc_core::sc_time& time) { return time.value(); }
inline std::uint64_t now_ps() { return to_ps(sc_core::sc_time_stamp()); }  // sc_time_stamp() in ps

// Returns sc_time::to_string() without the separators that a global std::locale puts between the digits.
inline std::string text_of(const sc_core::sc_time& time) {
  std::string text = time.to_string();
  const auto is_separator = [](char character) { return character < '0' || character > '9'; };
  const auto unit = text.begin() + static_cast<std::ptrdiff_t>(text.rfind(' '));
  text.erase(std::remove_if(text.begin(), unit, is_separator), unit);
  return text;
}

// Throws std::invalid_argument unless the kernel's time resolution is 1 ps, its default. The conversions
// above need it, in this module.
inline void check_resolution(const sc_core::sc_object& module) {
  if (sc_core::sc_get_time_resolution() != sc_core::sc_time(1, sc_core::SC_PS)) {
    throw std::invalid_argument(module.name() +
                                (": time resolution = " + text_of(sc_core::sc_get_time_resolution())) +
                                ": must be 1 ps, SystemC's default: leave sc_set_time_resolution() out, or "
                                "call it with (1, SC_PS)");
  }
}

}  // namespace stereotlm::kernel_time
