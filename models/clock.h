#pragma once

#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <systemc>

namespace stereotlm {

// A clock without drift: edge k lies at round(k * 10^6 / f_mhz) ps, halves up (contract section 3).
class Clock {
 public:
  // Throws std::invalid_argument if the kernel's time resolution is not 1 ps, its default.
  explicit Clock(double mhz) : mhz_(static_cast<long double>(mhz)) {
    if (sc_core::sc_get_time_resolution() != sc_core::sc_time(1, sc_core::SC_PS)) {
      throw std::invalid_argument("time resolution = " + sc_core::sc_get_time_resolution().to_string() +
                                  ": must be 1 ps");
    }
    const long double period_ps = 1e6L / mhz_;
    whole_period_ps_ = static_cast<std::uint64_t>(period_ps);
    if (static_cast<long double>(whole_period_ps_) * mhz_ != 1e6L) whole_period_ps_ = 0;
  }

  // Time of an edge, in ps.
  std::uint64_t edge_ps(std::uint64_t edge) const {
    if (whole_period_ps_ != 0) return edge * whole_period_ps_;
    return static_cast<std::uint64_t>(std::floor(static_cast<long double>(edge) * 1e6L / mhz_ + 0.5L));
  }
  // The first edge at or after a time in ps.
  std::uint64_t edge_at_or_after(std::uint64_t time_ps) const {
    auto edge = static_cast<std::uint64_t>(static_cast<long double>(time_ps) * mhz_ / 1e6L);
    while (edge > 0 && edge_ps(edge - 1) >= time_ps) --edge;
    while (edge_ps(edge) < time_ps) ++edge;
    return edge;
  }

  // Whether every edge of the two lies at the same time, known from their periods in whole ps.
  bool has_edges_of(const Clock& other) const {
    return whole_period_ps_ != 0 && whole_period_ps_ == other.whole_period_ps_;
  }

  static sc_core::sc_time to_time(std::uint64_t ps) { return sc_core::sc_time::from_value(ps); }
  static std::uint64_t to_ps(const sc_core::sc_time& time) { return time.value(); }

 private:
  long double mhz_;
  std::uint64_t whole_period_ps_;  // 0 if the period is not a whole number of ps
};

}  // namespace stereotlm
