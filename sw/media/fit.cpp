#include "sw/media/fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "models/fpga/core_config.h"

namespace stereotlm::media {
namespace {

std::string text_of(const Size& size) { return fmt::format("{}x{}", size.width, size.height); }

bool is_within(const Size& inner, const Size& outer) {
  return inner.width <= outer.width && inner.height <= outer.height;
}

// The first column or row that is kept of `length` ones: crop takes the middle, pad all.
int first_kept(int length, int of_image) { return std::max(0, (length - of_image) / 2); }

// The part of a truth that begins at a column and a row, each disparity less `offset`.
Truth part_of(const Truth& truth, const Size& size, int column, int row, int offset) {
  Truth part(size.width, size.height, truth.scale);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const int from = x + column;
      if (from < 0 || from >= truth.width || y + row >= truth.height) continue;
      part.at(x, y) = static_cast<float>(truth.at(from, y + row) - offset * truth.scale);
    }
  }
  return part;
}

}  // namespace

void Fit::check(const std::string& named, const Size& picture) const {
  if (!image || picture == *image || (name == "crop" && is_within(*image, picture)) ||
      (name == "pad" && is_within(picture, *image) && picture.width > 0 && picture.height > 0))
    return;
  const char* const rule = name.empty() ? "" : name == "crop" ? "at least " : "at most ";
  throw std::runtime_error(fmt::format("{}: {} pixels: must be {}as large as the board's images, {}{}", named,
                                       text_of(picture), rule, text_of(*image), cure(picture)));
}

std::string Fit::cure(const Size& picture) const {
  if (has_calibration) return "";
  const int rest = picture.width % static_cast<int>(fpga::kWidthRule.step);
  const std::string board = fmt::format("--set image.width={} --set image.height={}{}", picture.width - rest,
                                        picture.height, rest == 0 ? "" : " --fit crop");
  const char* const fit = is_within(picture, *image)   ? "--fit pad, or "
                          : is_within(*image, picture) ? "--fit crop, or "
                                                       : "";
  return fmt::format(": add {}{}", fit, board);
}

kernels::GrayImage Fit::fitted(const kernels::GrayImage& picture) const {
  if (name.empty() || !image) return picture;
  kernels::GrayImage result(image->width, image->height);
  const int left = first_kept(picture.width, image->width);
  const int top = first_kept(picture.height, image->height);
  for (int y = 0; y < image->height; ++y) {
    for (int x = 0; x < image->width; ++x)
      result.at(x, y) =
          picture.at(std::min(left + x, picture.width - 1), std::min(top + y, picture.height - 1));
  }
  return result;
}

Truth Fit::fitted(const Truth& truth) const {
  if (name.empty() || !image) return truth;
  return part_of(truth, *image, first_kept(truth.width, image->width),
                 first_kept(truth.height, image->height), 0);
}

Truth with_offset(const Truth& truth, int offset) {
  return part_of(truth, {truth.width, truth.height}, offset, 0, offset);
}

}  // namespace stereotlm::media
