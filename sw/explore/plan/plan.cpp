#include "sw/explore/plan/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "calib/split_mix.h"
#include "platform/config/board_keys.h"
#include "platform/config/tables.h"

namespace stereotlm::explore {
namespace {

std::string rules_of(const std::vector<platform::Diagnostic>& problems) {
  std::string text;
  for (const platform::Diagnostic& problem : problems) text += (text.empty() ? "" : "; ") + problem.text;
  return text;
}

// The Feistel network of shuffled_number(), for numbers of 2 * half_bits bits.
std::uint64_t permuted(std::uint64_t number, unsigned half_bits, std::uint64_t seed) {
  constexpr std::uint64_t kRounds = 6;
  const std::uint64_t mask = (std::uint64_t{1} << half_bits) - 1;
  std::uint64_t left = number >> half_bits;
  std::uint64_t right = number & mask;
  for (std::uint64_t round = 0; round < kRounds; ++round) {
    const std::uint64_t key = calib::mixed(seed + (round + 1) * calib::kSplitMixStep);
    const std::uint64_t next = left ^ (calib::mixed(right ^ key) & mask);
    left = right;
    right = next;
  }
  return left << half_bits | right;
}

}  // namespace

std::uint64_t shuffled_number(std::uint64_t size, std::uint64_t seed, std::uint64_t place) {
  unsigned half_bits = 1;
  while (std::uint64_t{1} << 2 * half_bits < size) ++half_bits;
  std::uint64_t number = permuted(place, half_bits, seed);
  while (number >= size) number = permuted(number, half_bits, seed);
  return number;
}

platform::YamlNode PlanValues::at(std::uint64_t number) const {
  if (!list.empty()) return list.at(number);
  const std::int64_t value = from + static_cast<std::int64_t>(number) * step;
  std::string text = std::to_string(std::abs(value));
  const auto behind = static_cast<std::size_t>(places);
  if (text.size() <= behind) text.insert(0, behind + 1 - text.size(), '0');
  if (behind > 0) text.insert(text.size() - behind, ".");
  return platform::YamlNode::plain((value < 0 ? "-" : "") + text, place);
}

Plan::Combination Plan::combination(std::uint64_t number) const {
  std::uint64_t rest = sample_ ? shuffled_number(product_, sample_->seed, number) : number;
  std::vector<std::uint64_t> places(axes_.size());
  for (std::size_t axis = axes_.size(); axis-- > 0; rest /= axes_[axis].size())
    places[axis] = rest % axes_[axis].size();
  Combination made = {*base_, run_};
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    for (std::size_t i = 0; i < axes_[axis].paths.size(); ++i) {
      const std::string& path = axes_[axis].paths[i];
      const platform::YamlNode value = axes_[axis].values[i].at(places[axis]);
      if (may_vary(path)) {
        apply_run_key(path, value, made.run);
      } else {
        made.draft.replace(path, value, path_);
      }
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

std::vector<std::string> Plan::varied() const {
  std::vector<std::string> paths;
  for (const Axis& axis : axes_) paths.insert(paths.end(), axis.paths.begin(), axis.paths.end());
  return paths;
}

}  // namespace stereotlm::explore
