#include "sw/media/panels.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "sw/media/color_map.h"

namespace stereotlm::media {
namespace {

constexpr int kMargin = 8;          // pixels, around each picture
constexpr int kCaptionHeight = 24;  // pixels
constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr double kFontScale = 0.5;

void draw_caption(cv::Mat& canvas, const std::string& caption, int left, int width) {
  const int full_width = cv::getTextSize(caption, kFont, kFontScale, 1, nullptr).width;
  const double scale = kFontScale * std::min(1.0, static_cast<double>(width) / std::max(full_width, 1));
  const cv::Scalar black(0, 0, 0);
  cv::putText(canvas, caption, {left, kMargin + kCaptionHeight - 8}, kFont, scale, black, 1, cv::LINE_AA);
}

cv::Mat shown(const Panel& panel) {
  if (panel.disparities != 0) return in_colors(panel.image, panel.disparities);
  cv::Mat picture;
  cv::cvtColor(view(panel.image), picture, cv::COLOR_GRAY2BGR);
  return picture;
}

}  // namespace

std::vector<std::uint8_t> encode_side_by_side_png(const std::vector<Panel>& panels) {
  if (panels.empty()) throw std::invalid_argument("panels = 0: at least one picture is needed");
  std::vector<cv::Mat> pictures;
  int width = kMargin;
  int height = 0;
  for (const Panel& panel : panels) {
    pictures.push_back(shown(panel));
    width += panel.image.width + kMargin;
    height = std::max(height, panel.image.height);
  }
  cv::Mat canvas(kMargin + kCaptionHeight + height + kMargin, width, CV_8UC3, cv::Scalar(255, 255, 255));
  int left = kMargin;
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const cv::Size size = pictures[i].size();
    pictures[i].copyTo(canvas(cv::Rect({left, kMargin + kCaptionHeight}, size)));
    draw_caption(canvas, panels[i].caption, left, size.width);
    left += size.width + kMargin;
  }
  return encode_png(canvas);
}

}  // namespace stereotlm::media
