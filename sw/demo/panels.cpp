#include "sw/demo/panels.h"

#include <algorithm>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "calib/canvas.h"
#include "models/kernels/lr_check.h"

namespace stereotlm::demo {
namespace {

cv::Mat view(const kernels::GrayImage& image) {
  return {image.height, image.width, CV_8UC1, const_cast<std::uint8_t*>(image.pixels.data())};
}

cv::Mat shown(const Panel& panel) {
  cv::Mat picture;
  if (panel.levels == 0) {
    cv::cvtColor(view(panel.image), picture, cv::COLOR_GRAY2BGR);
    return picture;
  }
  cv::Mat1f values;
  view(panel.image).convertTo(values, CV_32F);
  values.setTo(std::numeric_limits<float>::quiet_NaN(), view(panel.image) == kernels::kInvalidDisparity);
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

}  // namespace stereotlm::demo
