#include "sw/runs/sources/video_pairs.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace stereotlm::runs {
namespace {

using kernels::GrayImage;

void check_size(const std::string& file, int video_width, int video_height,
                const PictureSource::Video& options, const platform::BoardConfig& board) {
  if (options.layout == VideoLayout::kTwo) {
    if (const auto problem = size_problem(video_width, video_height, &board))
      throw std::runtime_error(fmt::format("'{}'{}", file, *problem));
    return;
  }
  const int width = board.image.width * (options.layout == VideoLayout::kSideBySide ? 2 : 1);
  const int height = board.image.height * (options.layout == VideoLayout::kTopBottom ? 2 : 1);
  if (video_width == width && video_height == height) return;
  throw std::runtime_error(
      fmt::format("'{}': {}x{} pixels: must be as large as two of the board's images, {}x{}, with "
                  "--video-layout {}: {}x{}",
                  file, video_width, video_height, board.image.width, board.image.height, options.layout_name,
                  width, height));
}

// The part of `image` that has this size and its top left pixel at (column, row).
GrayImage part_of(const GrayImage& image, int column, int row, int width, int height) {
  GrayImage part(width, height);
  for (int y = 0; y < height; ++y) {
    std::copy_n(&image.pixels[static_cast<std::size_t>(row + y) * static_cast<std::size_t>(image.width) +
                              static_cast<std::size_t>(column)],
                width, &part.at(0, y));
  }
  return part;
}

}  // namespace

VideoPairs::VideoPairs(const PictureSource::Video& options, const platform::BoardConfig* board)
    : PairSource("--video", 0), layout_(options.layout) {
  for (const std::string& file : options.files) {
    const auto check = [&](int width, int height) {
      if (board != nullptr) check_size(file, width, height, options, *board);
    };
    videos_.push_back(media::open_video(file, check));
    const media::Video& video = *videos_.back();
    if (video.frames() < video.stated_frames()) {
      notes_.push_back(fmt::format("--video '{}': {} frames can be decoded; its header says {}", file,
                                   video.frames(), video.stated_frames()));
    }
  }
  const media::Video& first = *videos_.front();
  const media::Video& last = *videos_.back();
  if (first.frames() != last.frames()) {
    throw std::runtime_error(fmt::format("'{}': {} frames: must have as many as '{}', {}",
                                         options.files.back(), last.frames(), options.files.front(),
                                         first.frames()));
  }
  set_length(first.frames());
}

host::StereoPair VideoPairs::load(std::uint64_t index) {
  const GrayImage& first = videos_.front()->frame(index);
  switch (layout_) {
    case VideoLayout::kSideBySide: {
      const int width = first.width / 2;
      return {part_of(first, 0, 0, width, first.height), part_of(first, width, 0, width, first.height)};
    }
    case VideoLayout::kTopBottom: {
      const int height = first.height / 2;
      return {part_of(first, 0, 0, first.width, height), part_of(first, 0, height, first.width, height)};
    }
    case VideoLayout::kTwo:
      break;
  }
  return {first, videos_.back()->frame(index)};
}

}  // namespace stereotlm::runs
