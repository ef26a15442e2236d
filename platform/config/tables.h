#pragma once

#include <optional>

#include "models/kernels/rectification_table.h"
#include "platform/config/board_config.h"

namespace stereotlm::platform {

// The look-up tables of a board; a side without table has none.
struct Tables {
  std::optional<kernels::RectificationTable> left;
  std::optional<kernels::RectificationTable> right;
};

// Without calibration a table is the identity (contract 1.1).
inline Tables identity_tables(const BoardConfig& board) {
  Tables tables;
  if (board.allocation.left_lut) tables.left = kernels::identity_table(board.image.width, board.image.height);
  if (board.allocation.right_lut)
    tables.right = kernels::identity_table(board.image.width, board.image.height);
  return tables;
}

// Throws std::invalid_argument if a side has a table and no place for it, or the other way round, or a table
// is not of the size of the images or has problems.
void check_tables(const BoardConfig& board, const Tables& tables);

}  // namespace stereotlm::platform
