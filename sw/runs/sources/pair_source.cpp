#include "sw/runs/sources/pair_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <future>
#include <stdexcept>

namespace stereotlm::runs {

std::optional<std::string> size_problem(int width, int height, const platform::BoardConfig* board) {
  if (board == nullptr || (width == board->image.width && height == board->image.height)) return std::nullopt;
  return fmt::format(": {}x{} pixels: must be as large as the board's images, {}x{}", width, height,
                     board->image.width, board->image.height);
}

const host::StereoPair& PairSource::pair(std::uint64_t frame) {
  const std::uint64_t index = frame % length_;
  const auto found =
      std::find_if(held_.begin(), held_.end(), [&](const Held& held) { return held.index == index; });
  if (found != held_.end()) {
    held_.splice(held_.begin(), held_, found);
    return held_.front().pair;
  }
  try {
    // Loads on a separate thread: the caller may be a SystemC process, whose stack is too small for decoders.
    held_.push_front({index, std::async(std::launch::async, [&] { return load(index); }).get()});
  } catch (const std::exception& error) {
    throw std::runtime_error(option_ + ' ' + error.what());
  }
  if (held_.size() > kHeld) held_.pop_back();
  return held_.front().pair;
}

}  // namespace stereotlm::runs
