#pragma once

#include <cstdint>
#include <string>

#include "models/host/ideal_host.h"
#include "platform/tables.h"
#include "sw/explore/figures.h"
#include "sw/explore/points.h"

namespace stereotlm::simulation {

// Simulates points of a plan without pixels, each in a child of this process.
class PointSimulator {
 public:
  PointSimulator() = default;
  // With the tables of a calibration, on boards that they fit.
  explicit PointSimulator(const platform::Tables& tables) : tables_(tables), is_calibrated_(true) {}

  // Throws std::runtime_error with what the run has ended with.
  explore::Figures operator()(const explore::Point& point);

 private:
  // The identities of the last point, unless they are given; most have the same.
  platform::Tables tables_;
  bool is_calibrated_ = false;
};

// The disparities of some frames of the core alone, all as one SHA-256, and the cycles that they took.
struct PixelRun {
  std::string disparities_sha256;
  std::uint64_t cycles = 0;
};

// In a child of this process, at fidelity fast. Throws as PointSimulator does.
PixelRun simulate_pixels(const platform::BoardConfig& board, const platform::Tables& tables,
                         host::FrameSource& pairs, std::uint64_t frames);

}  // namespace stereotlm::simulation
