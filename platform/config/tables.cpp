#include "platform/config/tables.h"

#include <fmt/format.h>

#include <stdexcept>

#include "models/kernels/joint_table.h"
#include "platform/config/buffer_layout.h"

namespace stereotlm::platform {
namespace {

void check(const std::optional<kernels::RectificationTable>& table, const BoardConfig& board, bool is_placed,
           const char* side) {
  if (table.has_value() != is_placed) {
    throw std::invalid_argument(
        fmt::format("{} table{}", side, is_placed ? " missing" : " given, but no buffer"));
  }
  if (!table) return;
  if (table->width != board.image.width || table->height != board.image.height) {
    throw std::invalid_argument(fmt::format("{} table: {} x {}: must be of the size of the images, {} x {}",
                                            side, table->width, table->height, board.image.width,
                                            board.image.height));
  }
  if (const auto found = kernels::problems(*table); !found.empty())
    throw std::invalid_argument(fmt::format("{} table: {}", side, found.front()));
}

}  // namespace

std::optional<std::string> calibration_size_problem(const BoardConfig& board, int width, int height) {
  if (width == board.image.width && height == board.image.height) return std::nullopt;
  return fmt::format("image size = {}x{}: must be that of the board's images, {}x{}", width, height,
                     board.image.width, board.image.height);
}

std::optional<std::string> calibration_buffer_problem(const BoardConfig& board) {
  const AllocationConfig& allocation = board.allocation;
  if (allocation.left_lut && allocation.right_lut) return std::nullopt;
  return fmt::format("needs a board with both tables, but {} = none",
                     key_of(allocation.left_lut ? Buffer::kRightLut : Buffer::kLeftLut));
}

std::optional<std::string> joint_tables_problem(const Tables& tables) {
  const auto found = kernels::joint_problems(*tables.left, *tables.right);
  if (found.empty()) return std::nullopt;
  return fmt::format("{}", fmt::join(found, "; "));
}

void check_tables(const BoardConfig& board, const Tables& tables) {
  check(tables.left, board, board.allocation.left_lut.has_value(), "left");
  check(tables.right, board, board.allocation.right_lut.has_value(), "right");
  if (board.fpga.joint_tables) {
    if (const auto problem = joint_tables_problem(tables)) throw std::invalid_argument(*problem);
  }
}

}  // namespace stereotlm::platform
