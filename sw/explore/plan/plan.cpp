#include "sw/explore/plan/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "platform/config/yaml_values.h"
#include "sw/explore/plan/shuffled_numbers.h"

namespace stereotlm::explore {
namespace {

using platform::BoardValue;

std::string rules_of(const std::vector<platform::Diagnostic>& problems) {
  std::string text;
  for (const platform::Diagnostic& problem : problems) text += (text.empty() ? "" : "; ") + problem.text;
  return text;
}

bool is_of_run(const std::string& path) { return path == kSourcePath || path == kFramesPath; }

}  // namespace

void Plan::apply(const std::string& path, const platform::YamlNode& value, const std::string& file,
                 platform::BoardDraft& draft, PointRun& run) {
  if (is_of_run(path)) {
    apply_to_run(path, value, run);
  } else {
    draft.replace(path, value, file);
  }
}

void Plan::apply_to_run(const std::string& path, const platform::YamlNode& value, PointRun& run) {
  if (path == kSourcePath) run.camera = value.text == "camera";
  if (path == kFramesPath) run.frames = static_cast<std::uint64_t>(platform::integer_of(value).value_or(0));
}

Plan::Combination Plan::combination(std::uint64_t number) const {
  Combination made = {*base_, run_};
  for (const PlanValue& value : values_at(number))
    apply(value.path, value.value, path_, made.draft, made.run);
  return made;
}

Point Plan::point(std::uint64_t number) const {
  const auto [draft, run] = combination(number);
  const platform::BoardDraft::Reading reading = draft.read_with_problems();
  if (!reading.problems.empty()) {
    return impossible_point(number, draft.to_yaml(), reading.board, run, rules_of(reading.problems));
  }
  auto problem = wrong_size(reading.board);
  if (!problem) problem = missing_table(reading.board);
  if (!problem) return make_point(number, reading.board, run);
  return impossible_point(number, to_yaml(reading.board), reading.board, run,
                          fmt::format("{}: {}", kCalibrationPath, *problem));
}

std::optional<std::string> Plan::use_calibration(const std::string& sha256, int width, int height) {
  run_.calibration = sha256;
  tables_width_ = width;
  tables_height_ = height;
  const auto problem = varies("image") ? std::nullopt : wrong_size(*base_board_);
  if (problem || varies("allocation")) return problem;
  return missing_table(*base_board_);
}

std::optional<std::string> Plan::wrong_size(const platform::BoardConfig& board) const {
  const bool is_right = tables_width_ == board.image.width && tables_height_ == board.image.height;
  if (run_.calibration.empty() || is_right) return std::nullopt;
  return fmt::format("image size = {}x{}: must be that of the board's images, {}x{}", tables_width_,
                     tables_height_, board.image.width, board.image.height);
}

std::optional<std::string> Plan::missing_table(const platform::BoardConfig& board) const {
  const platform::AllocationConfig& allocation = board.allocation;
  if (run_.calibration.empty() || (allocation.left_lut && allocation.right_lut)) return std::nullopt;
  return fmt::format("goes with a board that has both tables; allocation.{} = none",
                     allocation.left_lut ? "right_lut" : "left_lut");
}

bool Plan::varies(const std::string& path) const {
  const std::vector<std::string> paths = varied();
  return std::any_of(paths.begin(), paths.end(), [&path](const std::string& one) {
    return one == path || one.compare(0, path.size() + 1, path + '.') == 0;
  });
}

std::vector<PlanValue> Plan::values_at(std::uint64_t number) const {
  std::uint64_t rest = sample_ ? ShuffledNumbers(product_, sample_->seed).at(number) : number;
  std::vector<PlanValue> chosen;
  for (auto axis = axes_.rbegin(); axis != axes_.rend(); ++axis) {
    const std::uint64_t place = rest % axis->size();
    rest /= axis->size();
    for (std::size_t i = axis->paths.size(); i-- > 0;)
      chosen.push_back({axis->paths[i], axis->values[i].at(place)});
  }
  std::reverse(chosen.begin(), chosen.end());
  return chosen;
}

std::vector<std::string> Plan::varied() const {
  std::vector<std::string> paths;
  for (const Axis& axis : axes_) paths.insert(paths.end(), axis.paths.begin(), axis.paths.end());
  return paths;
}

}  // namespace stereotlm::explore
