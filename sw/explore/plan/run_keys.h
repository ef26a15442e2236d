#pragma once

#include <string>

#include "platform/config/board_keys.h"
#include "platform/config/yaml_tree.h"
#include "sw/explore/plan/points.h"

namespace stereotlm::explore {

// The keys of a run (kSourcePath, kFramesPath, kCalibrationPath) as values of a plan.

inline constexpr platform::IntegerRule kFramesRule = {1, 1'000'000};

// Whether points of one plan may have different values of the key.
bool may_vary(const std::string& run_key);

// The rule that the value of a run's key breaks; empty if it is valid.
std::string run_key_problem(const std::string& run_key, const platform::YamlNode& value);

// Gives the run a valid value of kSourcePath or kFramesPath.
void apply_run_key(const std::string& run_key, const platform::YamlNode& value, PointRun& run);

}  // namespace stereotlm::explore
