#include "sw/explore/plan/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "platform/config/board_keys.h"
#include "platform/config/tables.h"
#include "sw/explore/plan/shuffled_numbers.h"

namespace stereotlm::explore {
namespace {

std::string rules_of(const std::vector<platform::Diagnostic>& problems) {
  std::string text;
  for (const platform::Diagnostic& problem : problems) text += (text.empty() ? "" : "; ") + problem.text;
  return text;
}

}  // namespace

Plan::Combination Plan::combination(std::uint64_t number) const {
  Combination made = {*base_, run_};
  for (const PlanValue& value : values_at(number)) {
    if (may_vary(value.path)) {
      apply_run_key(value.path, value.value, made.run);
    } else {
      made.draft.replace(value.path, value.value, path_);
    }
  }
  return made;
}

Point Plan::point(std::uint64_t number) const {
  const auto [draft, run] = combination(number);
  const platform::BoardDraft::Reading reading = draft.read_with_problems();
  if (!reading.problems.empty()) {
    return impossible_point(number, draft.to_yaml(), reading.board, run, rules_of(reading.problems));
  }
  const auto problem = table_problem(reading.board, [](const char*) { return true; });
  if (!problem) return make_point(number, reading.board, run);
  return impossible_point(number, to_yaml(reading.board), reading.board, run,
                          fmt::format("{}: {}", kCalibrationPath, *problem));
}

std::optional<std::string> Plan::use_calibration(const std::string& sha256, int width, int height,
                                                 const std::optional<std::string>& joint_problem) {
  run_.calibration = sha256;
  tables_width_ = width;
  tables_height_ = height;
  tables_joint_problem_ = joint_problem;
  return table_problem(*base_board_, [this](const char* path) { return !varies(path); });
}

std::optional<std::string> Plan::table_problem(const platform::BoardConfig& board,
                                               const std::function<bool(const char*)>& is_checked) const {
  if (run_.calibration.empty()) return std::nullopt;
  std::optional<std::string> problem;
  if (is_checked("image")) problem = platform::calibration_size_problem(board, tables_width_, tables_height_);
  if (!problem && is_checked("allocation")) problem = platform::calibration_buffer_problem(board);
  if (!problem && is_checked("fpga.tables") && board.fpga.joint_tables) problem = tables_joint_problem_;
  return problem;
}

bool Plan::varies(const std::string& path) const {
  const std::vector<std::string> paths = varied();
  return std::any_of(paths.begin(), paths.end(), [&path](const std::string& one) {
    return one == path || platform::is_below(one, path);
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
