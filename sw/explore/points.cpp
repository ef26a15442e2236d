#include "sw/explore/points.h"

#include <fmt/format.h>

#include "sw/report/sha256.h"

namespace stereotlm::explore {

std::uint64_t frames_of(const PointRun& run, const platform::BoardConfig& board) {
  if (run.frames > 0) return run.frames;
  return run.camera ? kCameraFrames : platform::allocation_period_frames(board);
}

Point make_point(std::uint64_t number, const platform::BoardConfig& board, const PointRun& run) {
  Point point;
  point.number = number;
  point.board = board;
  point.yaml = to_yaml(board);
  point.run = {run.camera, frames_of(run, board), run.calibration};
  point.values = values_of(board);
  complete_point(point.yaml, point);
  return point;
}

void complete_point(const std::string& identity, Point& point) {
  const char* const source = point.run.camera ? "camera" : "preloaded";
  point.values.push_back({kSourcePath, source});
  point.values.push_back({kFramesPath, static_cast<std::int64_t>(point.run.frames)});
  std::string text = fmt::format("{}run: {{source: {}, frames: {}}}\n", identity, source, point.run.frames);
  if (!point.run.calibration.empty()) {
    point.values.push_back({kCalibrationPath, point.run.calibration});
    text += fmt::format("calibration: {}\n", point.run.calibration);
  }
  point.hash = report::sha256_hex(text.data(), text.size());
}

}  // namespace stereotlm::explore
