#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>

#include "models/host/frame_source.h"
#include "models/kernels/gray_image.h"
#include "platform/config/board_config.h"
#include "platform/config/tables.h"
#include "platform/statistics.h"
#include "sw/explore/plan/points.h"
#include "sw/explore/store/store.h"

namespace stereotlm::runs {

// Simulates points of a plan without pixels: a board alone in this process, a whole computer in a child.
class PointSimulator {
 public:
  PointSimulator() = default;
  // Uses the tables of a calibration on boards that they fit.
  explicit PointSimulator(const platform::Tables& tables) : tables_(tables), is_calibrated_(true) {}

  // Called repeatedly while a whole computer is simulated, with its steady rate so far. Returns true to give
  // up the simulation.
  using Hopeless = std::function<bool(const platform::SteadyRate& so_far)>;

  // Simulates a point. Throws std::runtime_error if that fails, and explore::GivenUp if it was given up.
  explore::Figures operator()(const explore::Point& point, const Hopeless& hopeless = {});

 private:
  // The given tables; if there are none, the identity tables of the last point, because the next point mostly
  // has the same.
  platform::Tables tables_;
  bool is_calibrated_ = false;
};

// How the core of a whole computer spends its time in the window of the steady rate: shares, which sum to 1.
// Key "": in frames. Each other key: waiting for the next start, by reason (sw/report/README.md, Time line).
// The run of `frames` frames must have a steady rate. Empty after an interrupt. Throws as PointSimulator.
std::map<std::string, double> core_time(const platform::BoardConfig& board, const platform::Tables& tables,
                                        std::uint64_t frames);

// The result of simulate_pixels().
struct PixelRun {
  std::string disparities_sha256;  // over the disparities of all frames
  std::uint64_t cycles = 0;        // sum over all frames
  kernels::GrayImage last;         // disparities of the last frame
};

// Simulates frames of the core alone, with pixels, in a child process at fidelity fast. Empty after an
// interrupt. Throws as PointSimulator does.
PixelRun simulate_pixels(const platform::BoardConfig& board, const platform::Tables& tables,
                         host::FrameSource& pairs, std::uint64_t frames);

// The frame rate of the core over frames 0..frames-1 if no port ever waited for a bank: each buffer is in a
// bank of its own, of the kind that it has now, and no host accesses the banks. Simulates one turn of the
// allocation's lists without pixels. Throws as platform::run_core() does.
double waitless_frames_per_second(const platform::BoardConfig& board, const platform::Tables& tables,
                                  std::uint64_t frames);

}  // namespace stereotlm::runs
