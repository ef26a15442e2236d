#pragma once

#include <fmt/format.h>

#include <optional>
#include <string>

#include "platform/config/board_config.h"

namespace stereotlm::runs {

// The problem of a picture with this size, as the text that follows its name in a message. nullopt if the
// size fits the board.
inline std::optional<std::string> size_problem(int width, int height, const platform::BoardConfig& board) {
  if (width == board.image.width && height == board.image.height) return std::nullopt;
  return fmt::format(": {}x{} pixels: must be as large as the board's images, {}x{}", width, height,
                     board.image.width, board.image.height);
}

}  // namespace stereotlm::runs
