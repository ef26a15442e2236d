#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "models/host/frame_source.h"
#include "models/kernels/stereo.h"
#include "platform/config/board_config.h"
#include "platform/config/tables.h"
#include "sw/explore/plan/plan.h"
#include "sw/media/load.h"
#include "sw/process/problems.h"
#include "sw/stats/accuracy.h"

namespace stereotlm::runs {

// The accuracy of boards over the pictures of a plan. The kernels compute the disparities, without a
// simulation: the board computes the same. Boards that compute the same disparities are computed once.
class PointQuality {
 public:
  PointQuality() = default;
  // Loads the pairs of a plan, or takes its seeds, and tells the plan what its pairs hold. Reports problems.
  PointQuality(explore::Plan& plan, process::Problems& problems);

  bool has_pictures() const { return !pairs_.empty() || !seeds_.empty(); }
  // `tables`: of the calibration; null without one. Nullopt if the plan has no pictures.
  std::optional<stats::Accuracy> of(const platform::BoardConfig& board, const platform::Tables* tables);

 private:
  struct Pair {
    host::StereoPair pictures;
    media::Truth truth;
  };
  // What the disparities of a board depend on, and their accuracy.
  struct Known {
    int width = 0;
    int height = 0;
    kernels::StereoConfig config;
    const std::uint32_t* left_table = nullptr;  // null: none
    const std::uint32_t* right_table = nullptr;
    stats::Accuracy accuracy;

    bool is_same(const Known& other) const;
  };

  std::vector<Pair> pairs_;
  std::vector<std::uint64_t> seeds_;  // frame 0 of each made scene
  std::vector<Known> known_;
};

}  // namespace stereotlm::runs
