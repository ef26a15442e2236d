#pragma once

#include <optional>
#include <string>

#include "models/kernels/rectification_table.h"
#include "platform/config/board_config.h"

namespace stereotlm::platform {

// The look-up tables of a board. A side without LUT port has no table.
struct Tables {
  std::optional<kernels::RectificationTable> left;
  std::optional<kernels::RectificationTable> right;
};

// The tables of a board without calibration (contract 1.1).
inline Tables identity_tables(const BoardConfig& board) {
  Tables tables;
  if (board.allocation.left_lut) tables.left = kernels::identity_table(board.image.width, board.image.height);
  if (board.allocation.right_lut)
    tables.right = kernels::identity_table(board.image.width, board.image.height);
  return tables;
}

// Why a board cannot have the tables of a calibration of pictures of that size; nothing: the size fits.
std::optional<std::string> calibration_size_problem(const BoardConfig& board, int width, int height);

// Why a board cannot have the tables of any calibration; nothing: it has a buffer for both.
std::optional<std::string> calibration_buffer_problem(const BoardConfig& board);

// Throws std::invalid_argument if a side has a table but the allocation has no bank for it, or the other way
// round; if a table has another size than the images; or if it has problems.
void check_tables(const BoardConfig& board, const Tables& tables);

}  // namespace stereotlm::platform
