#include "sw/explore/plan/points.h"

#include <fmt/format.h>

#include <utility>

#include "platform/yaml/yaml_tree.h"
#include "sw/files/text_forms.h"

namespace stereotlm::explore {

std::uint64_t frames_of(const PointRun& run, const platform::BoardConfig& board) {
  if (run.frames > 0) return run.frames;
  return platform::allocation_period_frames(board) + (run.camera ? kSteadyFrames : 0);
}

bool may_vary(const std::string& run_key) { return run_key == kSourcePath || run_key == kFramesPath; }

std::string run_key_problem(const std::string& run_key, const platform::YamlNode& value) {
  const bool is_source = value.is_scalar() && (value.text == "preloaded" || value.text == "camera");
  if (run_key == kSourcePath && !is_source)
    return "preloaded (the board alone) or camera (the whole computer)";
  if (run_key == kFramesPath && !kFramesRule.allows(platform::integer_of(value).value_or(0)))
    return kFramesRule.text() + ", the frames of each point";
  if (run_key == kCalibrationPath && (!value.is_scalar() || value.text.empty()))
    return "the file of a calibration, as written by stereotlm calibrate";
  return "";
}

void apply_run_key(const std::string& run_key, const platform::YamlNode& value, PointRun& run) {
  if (run_key == kSourcePath) run.camera = value.text == "camera";
  if (run_key == kFramesPath)
    run.frames = static_cast<std::uint64_t>(platform::integer_of(value).value_or(0));
}

Point make_point(std::uint64_t number, const platform::BoardConfig& board, const PointRun& run) {
  const PointRun its_run = {run.camera, frames_of(run, board), run.calibration};
  Point point = impossible_point(number, to_yaml(board), board, its_run, "");
  point.board = board;
  return point;
}

Point impossible_point(std::uint64_t number, const std::string& yaml, const platform::BoardConfig& asked_for,
                       const PointRun& run, const std::string& reason) {
  Point point;
  point.number = number;
  point.yaml = yaml;
  point.reason = reason;
  point.run = run;
  point.values = values_of(asked_for);
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

Points board_points(std::vector<platform::BoardConfig> boards, const PointRun& run) {
  const std::uint64_t size = boards.size();
  return {size, [boards = std::move(boards), run](std::uint64_t number) {
            return make_point(number, boards.at(number), run);
          }};
}

}  // namespace stereotlm::explore
