#pragma once

#include <optional>
#include <string>

#include "models/kernels/rectification_table.h"
#include "platform/config/board_config.h"

namespace stereotlm::platform {

// The look-up tables of a board. A side without LUT port has no table.
struct Tables {
  std::optional<kernels::RectificationTable> left;   // nullopt: the side has no buffer for a table
  std::optional<kernels::RectificationTable> right;  // nullopt: the side has no buffer for a table
};

// The tables of a board that is not calibrated: every entry is its own source (contract 1.1). An offset other
// than 0 is subtracted from each disparity: entry (x, y) of the left table is then pixel (x + offset, y).
inline Tables identity_tables(const BoardConfig& board, int disparity_offset = 0) {
  Tables tables;
  if (board.allocation.left_lut)
    tables.left = kernels::identity_table(board.image.width, board.image.height, disparity_offset);
  if (board.allocation.right_lut)
    tables.right = kernels::identity_table(board.image.width, board.image.height);
  return tables;
}

// The reason for which a board cannot have the tables of a calibration for pictures of width x height;
// nullopt if the size fits.
std::optional<std::string> calibration_size_problem(const BoardConfig& board, int width, int height);

// The reason for which a board cannot have the tables of any calibration: a side has no buffer for a table.
// It is nullopt if both sides have one.
std::optional<std::string> calibration_buffer_problem(const BoardConfig& board);

// The reasons for which the tables of a calibration cannot be joined into one table for both sides, as text;
// nullopt if they can. Both must be given.
std::optional<std::string> joint_tables_problem(const Tables& tables);

// Throws std::invalid_argument if a side has a table but no buffer for it, or a buffer but no table; if a
// table has another size than the images; if a table has problems; or if the board has joint tables, but
// these do not fit into one.
void check_tables(const BoardConfig& board, const Tables& tables);

}  // namespace stereotlm::platform
