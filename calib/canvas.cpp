#include "calib/canvas.h"

#include <cairo-ft.h>
#include <cairo.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "calib/opencv_conversions.h"
#include "calib/png.h"

namespace stereotlm::calib {
namespace {

constexpr double kFontSize = 14;  // pixels
constexpr double kSmallestScale = 0.5;
constexpr int kCaptionHeight = 24;  // pixels, above each picture
constexpr int kFractionBits = 4;    // of the fixed-point positions and lengths for OpenCV
// OpenCV cannot draw positions beyond this limit, in pixels.
constexpr double kFarthest = 1e5;

int fixed_point(double pixels) {
  return static_cast<int>(std::lround(std::clamp(pixels, -kFarthest, kFarthest) * (1 << kFractionBits)));
}

cv::Point fixed_point(const cv::Point2d& point) { return {fixed_point(point.x), fixed_point(point.y)}; }

using Surface = std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)>;
using Context = std::unique_ptr<cairo_t, decltype(&cairo_destroy)>;

// The letters of the font of figures, or Cairo's own where its file is missing. The file is read directly:
// a search for fonts takes longer than a drawing. The font stays until the process ends.
cairo_font_face_t* letters() {
  static cairo_font_face_t* const face = [] {
    FT_Library library = nullptr;
    FT_Face font = nullptr;
    if (FT_Init_FreeType(&library) == 0 && FT_New_Face(library, STEREOTLM_FONT, 0, &font) == 0)
      return cairo_ft_font_face_create_for_ft_face(font, FT_LOAD_NO_HINTING);
    return cairo_toy_font_face_create("@cairo:", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  }();
  return face;
}

Surface mask_of(int width, int height) {
  return {cairo_image_surface_create(CAIRO_FORMAT_A8, width, height), cairo_surface_destroy};
}

// A context with the font. The letters do not depend on settings of the user.
Context context_on(const Surface& surface, double scale) {
  Context context(cairo_create(surface.get()), cairo_destroy);
  cairo_font_options_t* const options = cairo_font_options_create();
  cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
  cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
  cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
  cairo_set_font_options(context.get(), options);
  cairo_font_options_destroy(options);
  cairo_set_font_face(context.get(), letters());
  cairo_set_font_size(context.get(), scale * kFontSize);
  return context;
}

// Returns nullopt if the text is not UTF-8.
std::optional<double> advance_of(const std::string& text, double scale) {
  const Surface surface = mask_of(1, 1);
  const Context context = context_on(surface, scale);
  cairo_text_extents_t extents;
  cairo_text_extents(context.get(), text.c_str(), &extents);
  if (cairo_status(context.get()) != CAIRO_STATUS_SUCCESS) return std::nullopt;
  return extents.x_advance;
}

// The text, or if it is not UTF-8, with '?' for each byte that is not ASCII.
std::string drawable(std::string text) {
  if (!advance_of(text, 1)) {
    std::replace_if(
        text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) > 127; }, '?');
  }
  return text;
}

}  // namespace

cv::Mat in_grey(const kernels::GrayImage& image) {
  cv::Mat result;
  cv::cvtColor(view(image), result, cv::COLOR_GRAY2BGR);
  return result;
}

cv::Mat in_colors(const cv::Mat1f& values, double first, double last) {
  const double step = last == first ? 0 : 255 / (last - first);
  cv::Mat1b levels(values.size());
  cv::Mat1b missing(values.size());
  for (int row = 0; row < values.rows; ++row) {
    for (int column = 0; column < values.cols; ++column) {
      const float value = values(row, column);
      missing(row, column) = std::isnan(value) ? 255 : 0;
      const double level = std::isnan(value) ? 0 : std::clamp((value - first) * step, 0.0, 255.0);
      levels(row, column) = static_cast<std::uint8_t>(std::lround(level));
    }
  }
  cv::Mat colors;
  cv::applyColorMap(levels, colors, cv::COLORMAP_VIRIDIS);
  colors.setTo(kMissing, missing);
  return colors;
}

int text_width(const std::string& text, double scale) {
  return static_cast<int>(std::ceil(advance_of(drawable(text), scale).value()));
}

void draw_text(cv::Mat& canvas, const std::string& text, cv::Point left_bottom, double scale,
               const cv::Scalar& color) {
  const std::string words = drawable(text);
  const int ascent = cvCeil(1.2 * scale * kFontSize);
  const cv::Size size(text_width(words, scale) + 2, ascent + cvCeil(0.4 * scale * kFontSize));
  const Surface surface = mask_of(size.width, size.height);
  {
    const Context context = context_on(surface, scale);
    cairo_move_to(context.get(), 0, ascent);
    cairo_show_text(context.get(), words.c_str());
  }
  cairo_surface_flush(surface.get());
  const cv::Mat1b mask(size.height, size.width, cairo_image_surface_get_data(surface.get()),
                       static_cast<std::size_t>(cairo_image_surface_get_stride(surface.get())));
  const cv::Rect whole({left_bottom.x, left_bottom.y - ascent}, size);
  const cv::Rect place = whole & cv::Rect({0, 0}, canvas.size());
  for (int y = place.y; y < place.br().y; ++y) {
    for (int x = place.x; x < place.br().x; ++x) {
      const double opacity = mask(y - whole.y, x - whole.x) / 255.0;
      auto& pixel = canvas.at<cv::Vec3b>(y, x);
      for (int i = 0; i < 3; ++i)
        pixel[i] = cv::saturate_cast<std::uint8_t>(pixel[i] + opacity * (color[i] - pixel[i]));
    }
  }
}

void draw_color_scale(cv::Mat& canvas, cv::Point left_bottom, int width, const std::string& first,
                      const std::string& last, const std::string& missing) {
  constexpr int kWidest = 160;
  constexpr int kNarrowest = 40;
  constexpr int kGap = 6;
  constexpr int kWideGap = 24;
  constexpr int kSwatchWidth = 20;
  const auto [left, bottom] = left_bottom;
  const int top = bottom - kTextHeight;
  const int texts = text_width(first) + text_width(last) + text_width(missing);
  const int colored = std::clamp(width - texts - 3 * kGap - kWideGap - kSwatchWidth, kNarrowest, kWidest);
  draw_text(canvas, first, {left, bottom});
  int at = left + text_width(first) + kGap;
  cv::Mat1f values(1, colored);
  for (int x = 0; x < colored; ++x) values(0, x) = static_cast<float>(x);
  const cv::Mat colors = in_colors(values, 0, colored - 1);
  for (int x = 0; x < colored; ++x) {
    cv::line(canvas, {at + x, top}, {at + x, bottom}, cv::Scalar(colors.at<cv::Vec3b>(0, x)));
  }
  at += colored + kGap;
  draw_text(canvas, last, {at, bottom});
  at += text_width(last) + kWideGap;
  cv::rectangle(canvas, {at, top}, {at + kSwatchWidth, bottom}, kMissing, cv::FILLED);
  draw_text(canvas, missing, {at + kSwatchWidth + kGap, bottom});
}

void draw_line(cv::Mat& canvas, const cv::Point2d& from, const cv::Point2d& to, const cv::Scalar& color,
               int thickness) {
  cv::line(canvas, fixed_point(from), fixed_point(to), color, thickness, cv::LINE_AA, kFractionBits);
}

void draw_circle(cv::Mat& canvas, const cv::Point2d& middle, double radius, const cv::Scalar& color) {
  cv::circle(canvas, fixed_point(middle), fixed_point(radius), color, 1, cv::LINE_AA, kFractionBits);
}

void draw_arrow(cv::Mat& canvas, const cv::Point2d& from, const cv::Point2d& to) {
  constexpr double kHeadLength = 6;  // pixels
  const double head = kHeadLength / std::max(cv::norm(to - from), kHeadLength);
  for (const auto& [color, thickness] : {std::pair(kBlack, 3), std::pair(kWhite, 1)}) {
    cv::arrowedLine(canvas, fixed_point(from), fixed_point(to), color, thickness, cv::LINE_AA, kFractionBits,
                    head);
  }
}

Montage side_by_side(const std::vector<Panel>& panels, int height_below) {
  Montage montage;
  cv::Point end(kMargin, 0);
  for (const Panel& panel : panels) {
    montage.places.emplace_back(cv::Point(end.x, kMargin + kCaptionHeight), panel.picture.size());
    const cv::Point corner = montage.places.back().br();
    end = {corner.x + kMargin, std::max(end.y, corner.y + kMargin)};
  }
  montage.canvas = cv::Mat(end.y + height_below, end.x, CV_8UC3, kWhite);
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const auto& [caption, picture] = panels[i];
    const cv::Rect& place = montage.places[i];
    picture.copyTo(montage.canvas(place));
    const double fits = static_cast<double>(place.width) / std::max(text_width(caption), 1);
    cv::Mat strip = montage.canvas({place.x, kMargin, place.width, kCaptionHeight});
    draw_text(strip, caption, {0, kCaptionHeight - 8}, std::clamp(fits, kSmallestScale, 1.0));
  }
  return montage;
}

std::vector<std::uint8_t> encode_png(const cv::Mat& canvas) {
  const cv::Mat whole = canvas.isContinuous() ? canvas : canvas.clone();
  return encode_png(whole.cols, whole.rows, PngPixel::kColour, whole.data);
}

}  // namespace stereotlm::calib
