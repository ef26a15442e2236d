#include "models/fpga/frame_counts.h"

#include <algorithm>

#include "models/kernels/sad_columns.h"

namespace stereotlm::fpga {
namespace {

FrameCounts::Lane lane_counts(const FrameGeometry& geometry, const AccessPattern& pattern, bool has_table,
                              const LaneControl& control) {
  FrameCounts::Lane lane;
  lane.slots = {control.taken(), pattern.empty_slots()};
  const std::uint64_t inside = geometry.slots - pattern.empty_slots();
  if (has_table) {
    lane.table.reads = inside;
    lane.table.invalid_entries = inside - pattern.pixel_accesses();
    lane.table.empty_slots = pattern.empty_slots();
  }
  lane.image.reads = has_table ? pattern.pixel_accesses() : inside;
  lane.image.passed_slots = geometry.slots - lane.image.reads;
  return lane;
}

}  // namespace

FrameCounts::FrameCounts(const CoreConfig& config, const AccessPattern& left_pattern,
                         const AccessPattern& right_pattern, const CoreControl& control,
                         std::uint64_t answered) {
  const FrameGeometry geometry(config);
  left = lane_counts(geometry, left_pattern, config.left_table, control.left());
  right = lane_counts(geometry, right_pattern, config.right_table, control.right());
  filter.pixels = geometry.slots + geometry.drain_cycles;
  // Also the first ones, of which the filter makes nothing yet; their windows stay in the array.
  filter.columns = filter.pixels / static_cast<std::uint64_t>(geometry.slots_per_column);
  rows.columns = filter.columns;
  sums.columns = filter.columns;
  sums.absolute_differences = sums.columns * static_cast<std::uint64_t>(config.window) *
                              static_cast<std::uint64_t>(config.disparities);
  const int rows_with_windows = std::max(0, geometry.height - 2 * geometry.radius);
  const int windows_in_row = std::max(0, geometry.width - 2 * geometry.radius);
  const auto matches =
      static_cast<std::uint64_t>(rows_with_windows) * static_cast<std::uint64_t>(windows_in_row);
  for (int column = 0; column < geometry.width; ++column) {
    sums.candidates +=
        static_cast<std::uint64_t>(rows_with_windows) *
        static_cast<std::uint64_t>(kernels::candidate_count(
            column, geometry.radius, geometry.width, geometry.height, config.window, config.disparities));
  }
  chain.columns = sums.columns - static_cast<std::uint64_t>(geometry.filter_half + geometry.radius);
  chain.matches = matches;
  tree.columns = chain.columns;
  tree.matches = matches;
  const std::uint64_t pixels = geometry.result_words * 4;
  check = {answered, pixels - answered};
  packed.words = control.match().words();
}

}  // namespace stereotlm::fpga
