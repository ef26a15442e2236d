#include "sw/demo/demo_pictures.h"

#include <algorithm>
#include <limits>
#include <opencv2/core.hpp>
#include <stdexcept>
#include <string>

#include "calib/canvas.h"
#include "models/kernels/lr_check.h"

namespace stereotlm::demo {
namespace {

using kernels::GrayImage;

std::string size_of(const GrayImage& image) {
  return std::to_string(image.width) + "x" + std::to_string(image.height);
}

std::uint8_t mean_of_four(const GrayImage& image, int column, int row) {
  const int sum = image.at(column, row) + image.at(column + 1, row) + image.at(column, row + 1) +
                  image.at(column + 1, row + 1);
  return static_cast<std::uint8_t>((sum + 2) / 4);
}

std::uint8_t top_left(const GrayImage& image, int column, int row) { return image.at(column, row); }

GrayImage middle_at_half_size(const GrayImage& full, std::uint8_t (*pixel)(const GrayImage&, int, int)) {
  const int first_column = (full.width / 2 - kWidth) / 2;
  const int first_row = (full.height / 2 - kHeight) / 2;
  GrayImage half(kWidth, kHeight);
  for (int row = 0; row < kHeight; ++row) {
    for (int column = 0; column < kWidth; ++column) {
      half.at(column, row) = pixel(full, 2 * (first_column + column), 2 * (first_row + row));
    }
  }
  return half;
}

cv::Mat shown(const Panel& panel) {
  if (panel.levels == 0) return calib::in_grey(panel.image);
  cv::Mat1f values(panel.image.height, panel.image.width);
  std::transform(panel.image.pixels.begin(), panel.image.pixels.end(), values.begin(),
                 [](std::uint8_t level) {
                   return level == kernels::kInvalidDisparity ? std::numeric_limits<float>::quiet_NaN()
                                                              : static_cast<float>(level);
                 });
  return calib::in_colors(values, 0, panel.levels - 1);
}

}  // namespace

std::vector<std::uint8_t> encode_side_by_side_png(const std::vector<Panel>& panels) {
  using calib::kMargin;
  if (panels.empty()) throw std::invalid_argument("panels = 0: at least one picture is needed");
  std::vector<cv::Mat> pictures;
  int width = kMargin;
  int height = 0;
  for (const Panel& panel : panels) {
    pictures.push_back(shown(panel));
    width += panel.image.width + kMargin;
    height = std::max(height, panel.image.height + (panel.levels == 0 ? 0 : calib::kScaleHeight));
  }
  const int top = kMargin + calib::kCaptionHeight;
  cv::Mat canvas(top + height + kMargin, width, CV_8UC3, calib::kWhite);
  int left = kMargin;
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const cv::Rect place({left, top}, pictures[i].size());
    pictures[i].copyTo(canvas(place));
    calib::draw_caption(canvas, panels[i].caption, place);
    if (panels[i].levels != 0) {
      calib::draw_color_scale(canvas, {left, place.br().y + calib::kScaleHeight - kMargin}, place.width,
                              panels[i].first, panels[i].last, panels[i].missing);
    }
    left += place.width + kMargin;
  }
  return calib::encode_png(canvas);
}

DemoPair make_demo_pair(const GrayImage& left, const GrayImage& right, const GrayImage& truth) {
  for (const GrayImage* other : {&right, &truth}) {
    if (other->width != left.width || other->height != left.height) {
      throw std::invalid_argument(std::string(other == &right ? "right" : "truth") + " picture = " +
                                  size_of(*other) + ": must be as large as the left one, " + size_of(left));
    }
  }
  if (left.width < 2 * kWidth || left.height < 2 * kHeight) {
    throw std::invalid_argument("left picture = " + size_of(left) + ": must be at least " +
                                size_of(GrayImage(2 * kWidth, 2 * kHeight)));
  }
  return {middle_at_half_size(left, mean_of_four), middle_at_half_size(right, mean_of_four),
          middle_at_half_size(truth, top_left)};
}

}  // namespace stereotlm::demo
