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

// Simulates points of a plan without pixels: a board alone in this process, a whole computer in a child.
class PointSimulator {
 public:
  PointSimulator() = default;
  // Uses the tables of a calibration on boards that they fit.
  explicit PointSimulator(const platform::Tables& tables) : tables_(tables), is_calibrated_(true) {}

  // Called repeatedly while a computer runs, with the frame that its core has started last. True gives the run
  // up.
  using Hopeless = std::function<bool(const platform::FrameBegin& last)>;

  // Throws std::runtime_error if the run fails, and explore::GivenUp if it was given up.
  explore::Figures operator()(const explore::Point& point, const Hopeless& hopeless = {});

 private:
  // The identity tables of the last point, if no tables are given: most points have the same.
  platform::Tables tables_;
  bool is_calibrated_ = false;
};

// The time of the core's first start in the whole computer, in seconds from time 0. Until then only the host
// uses the banks, and it only writes: the time does not depend on the allocation. One exception: if the two
// pictures are neighbours in one bank, one burst of the local bus may be saved. Runs in a child process. Throws
// as PointSimulator does.
double first_start_s(const platform::BoardConfig& board, const platform::Tables& tables);

// The SHA-256 over the disparities of some frames of the core alone, and the sum of their frame_cycles.
struct PixelRun {
  std::string disparities_sha256;
  std::uint64_t cycles = 0;
};

// Runs in a child process at fidelity fast. Throws as PointSimulator does.
PixelRun simulate_pixels(const platform::BoardConfig& board, const platform::Tables& tables,
                         host::FrameSource& pairs, std::uint64_t frames);

}  // namespace stereotlm::runs
