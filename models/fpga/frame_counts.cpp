#include "models/fpga/frame_counts.h"

#include <algorithm>

#include "models/kernels/cost_columns.h"

namespace stereotlm::fpga {
namespace {

FrameCounts::Lane lane_counts(const FrameGeometry& geometry, const AccessPattern& pattern, bool has_lut_port,
                              const LaneControl& control) {
  FrameCounts::Lane lane;
  lane.slots = {control.taken(), pattern.empty_slots()};
  const std::uint64_t inside = geometry.slots - pattern.empty_slots();
  if (has_lut_port) {
    lane.table.reads = inside;
    lane.table.invalid_entries = pattern.invalid_slots();
    lane.table.empty_slots = pattern.empty_slots();
  }
  lane.image.reads = pattern.pixel_accesses();
  lane.image.passed_slots = geometry.slots - lane.image.reads;
  return lane;
}

}  // namespace

FrameCounts::FrameCounts(const CoreConfig& config, const AccessPatterns& patterns, const FrameRun& run,
                         std::optional<std::uint64_t> answered) {
  const CoreControl& control = run.control();
  const FrameGeometry& geometry = control.geometry();
  for (const Side side : kSides) {
    const std::size_t index = index_of(side);
    const std::size_t lut = lut_port(side);
    lanes[index] = lane_counts(geometry, patterns[index], has_port(config, lut), control.lane(side));
    accesses[lut] = lanes[index].table.reads;
    accesses[pixel_port(side)] = lanes[index].image.reads;
  }
  if (config.joint_tables) lanes[0].table.invalid_entries += patterns[1].invalid_slots();
  filter.pixels = geometry.slots + geometry.drain_cycles;
  // This includes the first columns, for which the filter has no output yet; their windows do not leave the
  // array.
  filter.columns = filter.pixels / static_cast<std::uint64_t>(geometry.slots_per_column);
  census.columns = filter.columns;
  rows.columns = filter.columns;
  sums.columns = filter.columns;
  // The rows of a strip share the costs of their windows.
  sums.pixel_costs = sums.columns * static_cast<std::uint64_t>(config.window + config.rows - 1) *
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
  chain.columns = (sums.columns - static_cast<std::uint64_t>(geometry.half + geometry.radius)) *
                  static_cast<std::uint64_t>(config.rows);
  chain.matches = matches;
  tree.columns = chain.columns;
  tree.matches = matches;
  if (answered) check = LrCheck::Stats{*answered, geometry.result_words * 4 - *answered};
  packed.words = control.match().words();
  result = {run.writes(), static_cast<std::uint64_t>(control.result().most_queued()), 0};
  accesses[kResultPort] = geometry.result_words;
}

}  // namespace stereotlm::fpga
