#include "calib/canvas.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "calib/opencv_conversions.h"
#include "calib/png.h"

namespace stereotlm::calib {
namespace {

constexpr double kTextScale = 0.5;
constexpr int kTextHeight = 10;  // pixels, of a capital letter
constexpr int kMargin = 8;       // pixels, around each picture
constexpr int kCaptionHeight = 24;

int text_width(const std::string& text, double scale) {
  return cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, scale, 1, nullptr).width;
}

// Returns the width of the text.
int draw_text(cv::Mat& canvas, const std::string& text, cv::Point left_bottom, double scale = kTextScale) {
  cv::putText(canvas, text, left_bottom, cv::FONT_HERSHEY_SIMPLEX, scale, kBlack, 1, cv::LINE_AA);
  return text_width(text, scale);
}

}  // namespace

cv::Mat in_grey(const kernels::GrayImage& image) {
  cv::Mat result;
  cv::cvtColor(view(image), result, cv::COLOR_GRAY2BGR);
  return result;
}

cv::Mat in_colors(const cv::Mat1f& values, double first, double last) {
  const double step = last == first ? 0 : 255 / (last - first);
  cv::Mat levels, colors;
  values.convertTo(levels, CV_8U, step, -first * step);
  cv::applyColorMap(levels, colors, cv::COLORMAP_VIRIDIS);
  colors.setTo(kMissing, ~(values == values));  // NaN; OpenCV 4.6 misses some with !=
  return colors;
}

cv::Mat with_scale(const cv::Mat& picture, const ScaleTexts& texts) {
  constexpr int kHeight = 28;
  constexpr int kLeastWidth = 300;
  constexpr int kTextsWidth = 240;  // of texts such as those of this program, with the gaps
  constexpr int kGap = 6;
  cv::Mat canvas(picture.rows + kHeight, std::max(picture.cols, kLeastWidth), CV_8UC3, kWhite);
  picture.copyTo(canvas({0, 0, picture.cols, picture.rows}));
  const int bottom = canvas.rows - kMargin;
  const auto box = [&](int left, int width) {
    return cv::Rect(left, bottom - kTextHeight, width, kTextHeight);
  };

  int left = kMargin;
  left += draw_text(canvas, texts.first, {left, bottom}) + kGap;
  const int width = std::clamp(canvas.cols - kTextsWidth, 40, 160);
  cv::Mat1f ramp(kTextHeight, width);
  for (int x = 0; x < width; ++x) ramp.col(x) = static_cast<float>(x);
  in_colors(ramp, 0, width - 1).copyTo(canvas(box(left, width)));
  left += width + kGap;
  left += draw_text(canvas, texts.last, {left, bottom}) + 3 * kGap;
  const cv::Rect missing = box(left, 20);
  canvas(missing) = kMissing;
  draw_text(canvas, texts.missing, {missing.br().x + kGap, bottom});
  return canvas;
}

std::vector<std::uint8_t> encode_panels_png(const std::vector<Panel>& panels) {
  constexpr int kTop = kMargin + kCaptionHeight;
  cv::Size size(kMargin, 0);
  for (const Panel& panel : panels) {
    size.width += panel.picture.cols + kMargin;
    size.height = std::max(size.height, kTop + panel.picture.rows + kMargin);
  }
  cv::Mat canvas(size, CV_8UC3, kWhite);
  int left = kMargin;
  for (const auto& [caption, picture] : panels) {
    picture.copyTo(canvas({left, kTop, picture.cols, picture.rows}));
    const double fits = kTextScale * picture.cols / std::max(text_width(caption, kTextScale), 1);
    cv::Mat strip = canvas({left, kMargin, picture.cols, kCaptionHeight});
    draw_text(strip, caption, {0, kCaptionHeight - 8}, std::clamp(fits, kTextScale / 2, kTextScale));
    left += picture.cols + kMargin;
  }
  return encode_png(canvas);
}

std::vector<std::uint8_t> encode_png(const cv::Mat& picture) {
  const cv::Mat whole = picture.isContinuous() ? picture : picture.clone();
  return encode_png(whole.cols, whole.rows, PngPixel::kColour, whole.data);
}

}  // namespace stereotlm::calib
