#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "models/host/frame_source.h"
#include "models/kernels/gray_image.h"
#include "platform/config/board_config.h"
#include "platform/config/tables.h"
#include "platform/figures/statistics.h"
#include "platform/loop/core_loop.h"
#include "sw/explore/plan/points.h"
#include "sw/explore/store/store.h"
#include "sw/runs/simulation/point_quality.h"

namespace stereotlm::runs {

// Simulates points of a plan without pixels.
class PointSimulator {
 public:
  PointSimulator() = default;
  // Uses the tables of a calibration on boards that they fit.
  explicit PointSimulator(const platform::Tables& tables) : tables_(tables), is_calibrated_(true) {}

  // From now on each point also has the accuracy of its disparities.
  void judge(PointQuality quality) { quality_ = std::move(quality); }

  // Simulates a point. Throws std::runtime_error if that fails, and explore::GivenUp after an interrupt.
  // `with_core_waits`: for a whole computer with a steady rate, adds the shares of the time in its window in
  // which the core waits for its next start: figures `core_waits.REASON` (sw/report/README.md, Time line).
  explore::Figures operator()(const explore::Point& point, bool with_core_waits = false);

 private:
  const platform::CoreCounts& core_counts(const explore::Point& point);

  // The given tables; if there are none, the identity tables of the last point, because the next point mostly
  // has the same.
  platform::Tables tables_;
  bool is_calibrated_ = false;
  PointQuality quality_;
  // Of the last board alone, and the text that boards share if the core does not notice their difference.
  std::optional<platform::CoreCounts> core_;
  std::string core_key_;
};

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

// What makes the fast simulation of a board step every cycle (FastForward), which takes longer: "accesses of
// captures and of the host in sdram". Empty if nothing does.
std::string stepped_text(const platform::BoardConfig& board, const platform::Tables& tables, bool camera);

// The frame rate of the core over frames 0..frames-1 if no port ever waited for a bank: each buffer is in a
// bank of its own, of the kind that it has now, and no host accesses the banks. Simulates one turn of the
// allocation's lists without pixels. Throws as platform::run_core() does.
double waitless_frames_per_second(const platform::BoardConfig& board, const platform::Tables& tables,
                                  std::uint64_t frames);

}  // namespace stereotlm::runs
