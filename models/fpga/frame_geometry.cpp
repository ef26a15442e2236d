#include "models/fpga/frame_geometry.h"

namespace stereotlm::fpga {

FrameGeometry::FrameGeometry(const CoreConfig& config)
    : width(config.width),
      height(config.height),
      radius((config.window - 1) / 2),
      half((config.filter ? config.filter->half() : 0) + config.cost.half()),
      rows(config.rows),
      last_rows((height - 1) % rows + 1),
      folds(folds_of(config)),
      lanes(config.lanes),
      slots_per_column(config.fetch == Fetch::kColumn ? config.window + rows - 1 : 1),
      cycles_per_column((slots_per_column + lanes - 1) / lanes),
      lead_strips(config.fetch == Fetch::kColumn ? (std::max(0, half - radius) + rows - 1) / rows
                                                 : radius + half),
      strips((height + rows - 1) / rows + lead_strips),
      first_row(config.fetch == Fetch::kColumn ? half - radius - lead_strips * rows : 0),
      drain_columns(config.disparities - 1 + radius + half),
      columns(static_cast<std::uint64_t>(strips) * columns_per_strip()),
      slots(columns * static_cast<std::uint64_t>(slots_per_column)),
      consume_cycles(columns * static_cast<std::uint64_t>(cycles_per_column)),
      drain_cycles(static_cast<std::uint64_t>(drain_columns) * static_cast<std::uint64_t>(cycles_per_column)),
      result_delay_columns(static_cast<std::uint64_t>(drain_columns) +
                           static_cast<std::uint64_t>(lead_strips) * columns_per_strip()),
      last_strip_column(result_delay_columns +
                        static_cast<std::uint64_t>((height - 1) / rows) * columns_per_strip()),
      result_words(columns_per_strip() * static_cast<std::uint64_t>(height) / 4),
      result_delay_cycles(config.result_delay_cycles) {}

SlotCursor::SlotCursor(const FrameGeometry& geometry, int lane)
    : width_(geometry.width),
      height_(geometry.height),
      slots_per_column_(geometry.slots_of_lane(lane)),
      step_(geometry.lanes),
      rows_(geometry.rows),
      strip_row_(geometry.first_row + lane),
      row_(strip_row_),
      left_(geometry.columns * static_cast<std::uint64_t>(slots_per_column_)) {}

}  // namespace stereotlm::fpga
