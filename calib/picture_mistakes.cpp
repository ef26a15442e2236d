#include "calib/picture_mistakes.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <stdexcept>

#include "calib/grid.h"
#include "calib/rig_fit.h"

namespace stereotlm::calib {
namespace {

using RightOf = std::function<Corners(const Corners& left, const Corners& right)>;

Corners mapped(Corners corners, const Eigen::Matrix2d& map, const Eigen::Vector2d& shift = {0, 0}) {
  for (Eigen::Vector2d& corner : corners) corner = map * corner + shift;
  return corners;
}

// The right corners in their order, if the right picture is turned by `turn`. Their places stay.
RightOf turned(const GridShape& shape, const Eigen::Matrix2d& turn) {
  return [&shape, turn](const Corners& left, const Corners& right) {
    return mapped(ordered_like(left, shape, mapped(right, turn)), turn.transpose());
  };
}

// The right corners, if the right picture is mirrored: each row of them runs the other way, too.
RightOf mirrored(const GridShape& shape, int width) {
  return [&shape, width](const Corners& left, const Corners& right) {
    Corners result = mapped(right, Eigen::Vector2d(-1, 1).asDiagonal(), {width - 1, 0});
    for (auto row = result.begin(); row != result.end(); row += shape.columns)
      std::reverse(row, row + shape.columns);
    return ordered_like(left, shape, result);
  };
}

// The rig if the left picture i belongs to the right one partner(i), with these right corners. Nullopt if
// fewer than kFewestPairs are left, or no rig fits.
std::optional<RigFit> fit_with(const GridViews& views, const Rig& guess, const RightOf& right_of,
                               const std::function<std::size_t(std::size_t)>& partner) {
  constexpr std::size_t kMostPairs = 16;
  std::vector<GridPair> trial;
  for (std::size_t i = 0; i < views.pairs.size() && trial.size() < kMostPairs; ++i) {
    const auto& numbers = views.numbers;
    const auto other = std::find(numbers.begin(), numbers.end(), partner(numbers[i]));
    if (other == numbers.end()) continue;
    const Corners& left = views.pairs[i].left;
    const Corners& right = views.pairs[static_cast<std::size_t>(other - numbers.begin())].right;
    trial.push_back({left, right_of(left, right)});
  }
  if (trial.size() < kFewestPairs) return std::nullopt;
  try {
    return fit_all(views.shape, trial, guess);
  } catch (const std::runtime_error&) {
    return std::nullopt;
  }
}

}  // namespace

std::optional<PictureMistake> find_picture_mistake(const GridViews& views, const Rig& rig) {
  constexpr double kFits = 2;
  const Eigen::Matrix2d quarter{{0, -1}, {1, 0}};
  const RightOf as_is = turned(views.shape, Eigen::Matrix2d::Identity());
  const auto same = [](std::size_t picture) { return picture; };
  std::optional<PictureMistake> best;
  double least = kFits;
  Rig guess = rig;
  double roll = 0;  // of the best fit: by how much one camera is turned about its axis, degrees
  const auto attempt = [&](const RightOf& right_of, const auto& partner, const char* cause,
                           const std::string& cure) {
    const auto fit = fit_with(views, guess, right_of, partner);
    if (!fit || !(fit->evidence.ratio() < least)) return;
    least = fit->evidence.ratio();
    best = PictureMistake{cause, cure, fit->evidence.rig_rms_px};
    roll = fit->rig.roll_deg();
  };
  for (const Eigen::Matrix2d& turn :
       {Eigen::Matrix2d(quarter * quarter), quarter, Eigen::Matrix2d(quarter.transpose())})
    attempt(turned(views.shape, turn), same, "", "");
  if (best && roll > 135) {
    best->cause = "the pictures of one camera are upside down against those of the other";
    best->cure = "turn them by 180 degrees; or each by 90, if the cameras are turned opposite ways";
  } else if (best) {
    best->cause = "one camera is turned by 90 degrees against the other";
    best->cure = "turn the camera back, and take the pictures again";
  }
  for (const std::size_t shift : {1U, 2U, 3U}) {
    const char* const cause = "the pictures are paired wrongly";
    const char* const cure =
        "leave out {0} {1} picture{3} at the beginning, and {0} {2} picture{3} at the end";
    const char* const plural = shift == 1 ? "" : "s";
    attempt(
        as_is, [shift](std::size_t picture) { return picture + shift; }, cause,
        fmt::format(fmt::runtime(cure), shift, "right", "left", plural));
    attempt(
        as_is, [shift](std::size_t picture) { return picture - shift; }, cause,
        fmt::format(fmt::runtime(cure), shift, "left", "right", plural));
  }
  attempt(
      as_is, [&views](std::size_t picture) { return views.pictures - 1 - picture; },
      "the pictures of one camera are in reverse order", "name them in the order of the others");
  CameraModel& camera = guess.right;
  camera.matrix(0, 2) = views.width - 1 - camera.matrix(0, 2);
  camera.distortion[3] = -camera.distortion[3];  // p2
  attempt(mirrored(views.shape, views.width), same, "the pictures of one camera are mirrored",
          "mirror them, left to right");
  return best;
}

}  // namespace stereotlm::calib
