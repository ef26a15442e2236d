#include "sw/runs/pair_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sw/process/streams.h"
#include "sw/runs/sources/calibration_library.h"

namespace stereotlm::runs {
namespace {

// Points of the left picture that are found further left in the right one. Objects may be nearer than the
// board can see: half of the picture is searched.
calib::MatchedRows matched_rows(const RunInput& input, const kernels::GrayImage& left,
                                const kernels::GrayImage& right) {
  const auto rectified = [](const kernels::GrayImage& picture, const auto& table) {
    return table ? kernels::rectify(picture, *table) : picture;
  };
  const int searched = std::max(input.board.matcher.disparities, input.board.image.width / 2);
  return calibration_functions().matched_rows(rectified(left, input.tables.left),
                                              rectified(right, input.tables.right), searched);
}

// What says that the pictures are exchanged; nullopt unless many more points are found if they are.
std::optional<std::string> exchange_text(const RunInput& input, const host::StereoPair& pair,
                                         const calib::MatchedRows& as_given) {
  constexpr std::size_t kMany = 20;
  constexpr std::size_t kManyMore = 5;  // times as many
  const calib::MatchedRows exchanged = matched_rows(input, pair.right, pair.left);
  if (exchanged.in_row < std::max(kMany, kManyMore * as_given.in_row)) return std::nullopt;
  return fmt::format(
      "of {} conspicuous points of a left picture {} are found in the same row of the right one, further "
      "left; "
      "with the sides exchanged {} of {}: are left and right exchanged?",
      as_given.points, as_given.in_row, exchanged.in_row, exchanged.points);
}

}  // namespace

void check_pair(const RunInput& input, const host::StereoPair& pair) {
  const std::vector<std::uint8_t>& pixels = pair.left.pixels;
  const bool is_uniform =
      std::all_of(pixels.begin(), pixels.end(), [&](auto each) { return each == pixels[0]; });
  if (!is_uniform && pixels == pair.right.pixels) {
    return process::say("warning",
                        "the left and the right picture are the same: a pair has one of each camera");
  }
  if (!input.calibration) return;
  constexpr double kDoubtful = 1.5;  // pixels
  constexpr std::size_t kFew = 10;
  constexpr std::size_t kMany = 50;
  const calib::MatchedRows rows = matched_rows(input, pair.left, pair.right);
  if (const auto text = exchange_text(input, pair, rows))
    return process::say("warning", "--calibration: " + *text);
  std::string text = fmt::format(
      "--calibration: of {} conspicuous points of the first left picture {} are found in the right one",
      rows.points, rows.error.corners);
  bool is_doubtful = false;
  if (rows.error.corners < kFew) {
    is_doubtful = rows.points >= kMany;
    text += is_doubtful ? ": is it of this rig?" : ": too few to see whether it is of this rig";
  } else {
    is_doubtful = rows.error.mean_px > kDoubtful;
    text += fmt::format("; their rows differ by {:.2f} pixels on average{}", rows.error.mean_px,
                        is_doubtful ? ": is it of this rig?" : "");
  }
  process::say(is_doubtful ? "warning" : "note", text);
}

void say_if_exchanged(const RunInput& input, const host::StereoPair& pair) {
  const auto text = exchange_text(input, pair, matched_rows(input, pair.left, pair.right));
  if (text)
    process::say("note",
                 *text + " If not, all disparities are below 0: a negative --disparity-offset finds them");
}

}  // namespace stereotlm::runs
