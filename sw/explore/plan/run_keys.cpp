#include "sw/explore/plan/run_keys.h"

#include "platform/config/yaml_values.h"

namespace stereotlm::explore {

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

}  // namespace stereotlm::explore
