// stereotlm-stereobm runs OpenCV's StereoBM on a pair with ground truth, and measures it as `stereotlm run
// --truth` does.
#include <charconv>
#include <cmath>
#include <cstdio>
#include <exception>
#include <nlohmann/json.hpp>
#include <opencv2/calib3d.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "calib/opencv_conversions.h"
#include "sw/media/load.h"
#include "sw/stats/accuracy.h"

namespace stereotlm::bench {
namespace {

using kernels::GrayImage;

constexpr const char* kUsage =
    "usage: stereotlm-stereobm LEFT RIGHT TRUTH TRUTH_SCALE DISPARITIES WINDOW\n"
    "         one JSON object a line and setting; DISPARITIES a multiple of 16\n";

struct Setting {
  const char* name;
  bool plain;         // no uniqueness, no texture threshold
  int disp12MaxDiff;  // left-right tolerance; -1: off
};

constexpr Setting kSettings[] = {{"OpenCV's defaults", false, -1},
                                 {"plain, left-right check off", true, -1},
                                 {"plain, left-right tolerance 0", true, 0},
                                 {"plain, left-right tolerance 1", true, 1}};

int parse_integer(const char* name, std::string_view text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) {
    throw std::invalid_argument(std::string(name) + " = " + std::string(text) + ": must be an integer");
  }
  return value;
}

// StereoBM returns sixteenths of a pixel, and -1 pixel where it has no disparity.
GrayImage whole_disparities(const cv::Mat& sixteenths) {
  GrayImage disparity(sixteenths.cols, sixteenths.rows, 255);
  for (int row = 0; row < disparity.height; ++row) {
    for (int column = 0; column < disparity.width; ++column) {
      const int value = sixteenths.at<std::int16_t>(row, column);
      if (value == -cv::StereoMatcher::DISP_SCALE) continue;
      disparity.at(column, row) = static_cast<std::uint8_t>(std::floor(value / 16.0 + 0.5));
    }
  }
  return disparity;
}

GrayImage match(const GrayImage& left, const GrayImage& right, int disparities, int window,
                const Setting& setting) {
  const auto matcher = cv::StereoBM::create(disparities, window);
  matcher->setDisp12MaxDiff(setting.disp12MaxDiff);
  if (setting.plain) {
    matcher->setUniquenessRatio(0);
    matcher->setTextureThreshold(0);
  }
  cv::Mat sixteenths;
  matcher->compute(calib::view(left), calib::view(right), sixteenths);
  return whole_disparities(sixteenths);
}

nlohmann::json number(const std::optional<double>& value) {
  return value ? nlohmann::json(*value) : nlohmann::json();
}

void run(char** argument) {
  const GrayImage left = media::load_gray(argument[0]).image;
  const GrayImage right = media::load_gray(argument[1]).image;
  const media::Truth truth = media::load_truth(argument[2], parse_integer("TRUTH_SCALE", argument[3]));
  const int disparities = parse_integer("DISPARITIES", argument[4]);
  const int window = parse_integer("WINDOW", argument[5]);
  if (disparities < 16 || disparities > 240)
    throw std::invalid_argument("DISPARITIES = " + std::to_string(disparities) + ": must be 16..240");
  for (const Setting& setting : kSettings) {
    const auto found = stats::accuracy(match(left, right, disparities, window, setting), truth);
    const nlohmann::ordered_json row = {{"setting", setting.name},
                                        {"bad_1_percent", number(found.bad_1_percent)},
                                        {"bad_2_percent", number(found.bad_2_percent)},
                                        {"answered_percent", number(found.answered_percent)}};
    std::puts(row.dump().c_str());
  }
}

}  // namespace
}  // namespace stereotlm::bench

int main(int argc, char** argv) {
  if (argc != 7) {
    std::fputs(stereotlm::bench::kUsage, stderr);
    return 2;
  }
  try {
    stereotlm::bench::run(argv + 1);
  } catch (const std::exception& exception) {
    std::fprintf(stderr, "stereotlm-stereobm: %s\n", exception.what());
    return 1;
  }
}
