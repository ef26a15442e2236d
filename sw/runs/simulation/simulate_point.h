#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "models/host/frame_source.h"
#include "platform/bounds.h"
#include "platform/config/tables.h"
#include "sw/explore/plan/figures.h"
#include "sw/explore/plan/points.h"

namespace stereotlm::runs {

// Simulates points of a plan without pixels: the board alone in this process, each computer in a child of it.
class PointSimulator {
 public:
  PointSimulator() = default;
  // With the tables of a calibration, on boards that they fit.
  explicit PointSimulator(const platform::Tables& tables) : tables_(tables), is_calibrated_(true) {}

  // Asked from time to time while a computer runs, with the frame that its core has started last: whether the
  // run is not worth its end.
  using Hopeless = std::function<bool(const platform::FrameBegin& last)>;

  // Throws std::runtime_error with what the run has ended with, and explore::GivenUp if it is hopeless.
  explore::Figures operator()(const explore::Point& point, const Hopeless& hopeless = {});

 private:
  // The identities of the last point, unless they are given; most have the same.
  platform::Tables tables_;
  bool is_calibrated_ = false;
};

// When the core of the whole computer starts for the first time, in seconds from time 0. Until then the host
// alone uses the banks, and only writes: the time does not depend on where the buffers lie, but for a burst
// of the local bus that is saved where the last words of one picture and the first of the other, in the same
// bank, are neighbours. In a child of this process. Throws as PointSimulator does.
double first_start_s(const platform::BoardConfig& board, const platform::Tables& tables);

// The disparities of some frames of the core alone, all as one SHA-256, and the sum of their frame_cycles.
struct PixelRun {
  std::string disparities_sha256;
  std::uint64_t cycles = 0;
};

// In a child of this process, at fidelity fast. Throws as PointSimulator does.
PixelRun simulate_pixels(const platform::BoardConfig& board, const platform::Tables& tables,
                         host::FrameSource& pairs, std::uint64_t frames);

}  // namespace stereotlm::runs
