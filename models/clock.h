#pragma once

#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <systemc>

#include "models/rounding.h"

namespace stereotlm {

// A clock without drift: edge k lies at round(k * 10^6 / f_mhz) ps, halves up (contract section 3).
class Clock {
 public:
  // Throws std::invalid_argument if the kernel's time resolution is not 1 ps, its default.
  explicit Clock(double mhz)
      : mhz_(static_cast<long double>(mhz)), period_ps_(1e6 / mhz), edges_per_ps_(mhz / 1e6) {
    if (sc_core::sc_get_time_resolution() != sc_core::sc_time(1, sc_core::SC_PS)) {
      throw std::invalid_argument("time resolution = " + sc_core::sc_get_time_resolution().to_string() +
                                  ": must be 1 ps");
    }
    whole_period_ps_ = static_cast<std::uint64_t>(1e6L / mhz_);
    if (static_cast<long double>(whole_period_ps_) * mhz_ != 1e6L) whole_period_ps_ = 0;
  }

  // Time of an edge, in ps.
  std::uint64_t edge_ps(std::uint64_t edge) const {
    if (whole_period_ps_ != 0) return edge * whole_period_ps_;
    if (const auto time_ps = rounded_if_certain(static_cast<double>(edge) * period_ps_)) return *time_ps;
    return static_cast<std::uint64_t>(std::floor(static_cast<long double>(edge) * 1e6L / mhz_ + 0.5L));
  }
  // The first edge at or after a time in ps.
  std::uint64_t edge_at_or_after(std::uint64_t time_ps) const {
    const double edges = static_cast<double>(time_ps) * edges_per_ps_;
    auto edge = static_cast<std::uint64_t>(edges);
    // An edge lies up to half a ps off its exact place; twice that, and the error of `edges`, leave no doubt.
    const double past_edge = edges - static_cast<double>(edge);
    const double doubt = edges_per_ps_ + edges * 0x1p-50;
    if (past_edge > doubt && past_edge < 1 - doubt) return edge + 1;
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
  double period_ps_;  // near enough to guess from, like edges_per_ps_
  double edges_per_ps_;
  std::uint64_t whole_period_ps_;  // 0 if the period is not a whole number of ps
};

}  // namespace stereotlm
