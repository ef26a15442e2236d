#include "sw/explore/plan/points.h"

#include <fmt/format.h>

#include "sw/files/sha256.h"

namespace stereotlm::explore {

std::uint64_t frames_of(const PointRun& run, const platform::BoardConfig& board) {
  if (run.frames > 0) return run.frames;
  return run.camera ? kCameraFrames : platform::allocation_period_frames(board);
}

namespace {

// What is the same for each.
Point point_of(std::uint64_t number, const std::string& yaml, const platform::BoardConfig& board,
               const PointRun& run) {
  Point point;
  point.number = number;
  point.yaml = yaml;
  point.run = run;
  point.values = values_of(board);
  const char* const source = run.camera ? "camera" : "preloaded";
  point.values.push_back({kSourcePath, source});
  point.values.push_back({kFramesPath, static_cast<std::int64_t>(run.frames)});
  std::string text = fmt::format("{}run: {{source: {}, frames: {}}}\n", yaml, source, run.frames);
  if (!run.calibration.empty()) {
    point.values.push_back({kCalibrationPath, run.calibration});
    text += fmt::format("calibration: {}\n", run.calibration);
  }
  point.hash = files::sha256_hex(text.data(), text.size());
  return point;
}

}  // namespace

Point make_point(std::uint64_t number, const platform::BoardConfig& board, const PointRun& run) {
  Point point = point_of(number, to_yaml(board), board, {run.camera, frames_of(run, board), run.calibration});
  point.board = board;
  return point;
}

Point impossible_point(std::uint64_t number, const std::string& yaml, const platform::BoardConfig& asked_for,
                       const PointRun& run, const std::string& reason) {
  Point point = point_of(number, yaml, asked_for, run);
  point.reason = reason;
  return point;
}

}  // namespace stereotlm::explore
