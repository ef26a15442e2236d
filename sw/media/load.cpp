#include "sw/media/load.h"

#include <fmt/format.h>

#include <cctype>
#include <cstddef>
#include <stdexcept>
#include <utility>

#include "sw/files/whole_file.h"
#include "sw/media/decode.h"
#include "sw/process/command.h"

namespace stereotlm::media {
namespace {

using std::literals::string_view_literals::operator""sv;

// The largest file that is read: enough for the largest picture of a board with its pixels as text, or in
// colour with much metadata.
constexpr std::uintmax_t kMostBytes = 16 * fpga::kWidthRule.max * fpga::kHeightRule.max;

constexpr std::string_view kPng = "\x89PNG\r\n\x1A\n";

bool begins(std::string_view bytes, std::string_view text) { return bytes.substr(0, text.size()) == text; }

bool is_pnm(std::string_view bytes) {
  return bytes.size() > 2 && bytes[0] == 'P' && "1234567fF"sv.find(bytes[1]) != std::string_view::npos &&
         std::isspace(static_cast<unsigned char>(bytes[2])) != 0;
}

// Formats that OpenCV decodes: BMP, Sun raster, TIFF, WebP, and JPEG 2000 with and without a container.
bool is_for_opencv(std::string_view bytes) {
  constexpr std::string_view kBegins[] = {"BM"sv,    "\x59\xA6\x6A\x95"sv,         "II*\0"sv,
                                          "MM\0*"sv, "\0\0\0\x0CjP  \r\n\x87\n"sv, "\xFF\x4F\xFF\x51"sv};
  return std::any_of(std::begin(kBegins), std::end(kBegins),
                     [bytes](std::string_view text) { return begins(bytes, text); }) ||
         (begins(bytes, "RIFF") && bytes.substr(0, 15).substr(8) == "WEBPVP8");
}

Picture decoded(std::string_view bytes) {
  if (bytes.empty()) refuse_picture("an empty file", kPixelRule);
  if (begins(bytes, kPng)) return decode_png(bytes);
  if (begins(bytes, "\xFF\xD8\xFF")) return decode_jpeg(bytes);
  if (is_pnm(bytes)) return decode_pnm(bytes);
  if (is_for_opencv(bytes)) return decoders().decode_picture(bytes);
  refuse_picture("not a picture in a format that is read",
                 "a picture must be PNG, JPEG, BMP, PGM, PPM, PAM, TIFF, WebP, JPEG 2000 or Sun raster");
}

// What `decode` makes of the bytes of a file, which are `content` if that is there.
template <typename Decode>
auto read(const std::string& path, const Decode& decode, const std::string* content = nullptr) {
  const std::string bytes = content != nullptr ? *content : files::read_whole_file(path, kMostBytes);
  try {
    return decode(bytes);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(fmt::format("'{}': {}", path, error.what()));
  }
}

// As OpenCV's BGR2GRAY: weights in 1/32768, halves up.
std::uint8_t grey_of(const std::uint8_t* bgr) {
  return static_cast<std::uint8_t>((bgr[0] * 3735 + bgr[1] * 19235 + bgr[2] * 9798 + (1 << 14)) >> 15);
}

kernels::GrayImage to_gray_image(Picture picture) {
  kernels::GrayImage image;
  image.width = picture.width;
  image.height = picture.height;
  if (picture.channels == 1) {
    image.pixels = std::move(picture.samples);
    return image;
  }
  const auto channels = static_cast<std::size_t>(picture.channels);
  image.pixels.reserve(picture.samples.size() / channels);
  for (auto pixel = picture.samples.begin(); pixel != picture.samples.end(); pixel += picture.channels)
    image.pixels.push_back(grey_of(&*pixel));
  return image;
}

}  // namespace

LoadedGray load_gray(const std::string& path) {
  Picture picture = read(path, decoded);
  const bool is_colour = picture.channels != 1;
  const std::vector<std::string> notes = picture.notes;
  return {to_gray_image(std::move(picture)), is_colour, notes};
}

Truth load_truth(const std::string& path, std::optional<double> scale, const std::string* content) {
  if (scale && (!std::isfinite(*scale) || *scale <= 0))
    throw std::invalid_argument("truth scale = " + std::to_string(*scale) + ": must be positive and finite");
  return read(
      path,
      [scale](const std::string& bytes) {
        Truth truth;
        if (bytes.size() > 2 && begins(bytes, "Pf") &&
            std::isspace(static_cast<unsigned char>(bytes[2])) != 0) {
          truth = decode_pfm(bytes);
        } else if (begins(bytes, kPng) && is_deep_png(bytes)) {
          if (!scale)
            refuse_picture("16-bit grey", "its scale must be given: --truth-scale 256 for one of KITTI");
          truth = decode_deep_png(bytes);
        } else {
          Picture picture = decoded(bytes);
          if (picture.channels != 1) refuse_picture("8-bit colour", "ground truth must be grey");
          truth = {to_gray_image(std::move(picture)), 1};
        }
        truth.scale = scale.value_or(1);
        return truth;
      },
      content);
}

const Decoders& decoders() {
  static const auto& functions = *static_cast<const Decoders*>(process::plugin_symbol(
      "libstereotlm_decoders.so", "stereotlm_decoders", "decodes videos and the rarer formats of pictures"));
  return functions;
}

std::unique_ptr<Video> open_video(const std::string& path, const VideoSizeCheck& check) {
  files::check_regular_file(path);
  return decoders().open_video(path, check);
}

}  // namespace stereotlm::media
