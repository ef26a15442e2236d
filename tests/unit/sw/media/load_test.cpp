#include "sw/media/load.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <utility>

#include "tests/support/scratch_folder.h"

namespace stereotlm::media {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

std::string encoded(const char* extension, const cv::Mat& picture, const std::vector<int>& parameters = {}) {
  std::vector<std::uint8_t> bytes;
  if (!cv::imencode(extension, picture, bytes, parameters)) throw std::runtime_error(extension);
  return {bytes.begin(), bytes.end()};
}

constexpr int kWidth = 48;  // at least 32 each: OpenCV writes no smaller JPEG 2000
constexpr int kHeight = 32;

cv::Mat noise(int type) {
  cv::Mat picture(kHeight, kWidth, type);
  cv::RNG(7).fill(picture, cv::RNG::UNIFORM, 0, 256);
  return picture;
}

std::vector<std::uint8_t> pixels_of(const cv::Mat& grey) { return {grey.datastart, grey.dataend}; }

std::vector<std::uint8_t> grey_pixels_of(const cv::Mat& colour) {
  cv::Mat grey;
  cv::cvtColor(colour, grey, cv::COLOR_BGR2GRAY);
  return pixels_of(grey);
}

// PNG: length, type, data, CRC-32 of type and data.
std::string png_chunk(const std::string& type, const std::string& data) {
  const auto big_endian = [](std::uint32_t value) {
    std::string text;
    for (int shift = 24; shift >= 0; shift -= 8) text += static_cast<char>(value >> shift);
    return text;
  };
  std::uint32_t crc = ~0U;
  for (const char c : type + data) {
    crc ^= static_cast<std::uint8_t>(c);
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1U) != 0 ? 0xEDB88320U ^ crc >> 1U : crc >> 1U;
  }
  return big_endian(static_cast<std::uint32_t>(data.size())) + type + data + big_endian(~crc);
}

// A grey PNG with `extra` chunks behind its header, of another colour type if asked for (3: palette).
std::string png_with(const std::string& grey_png, const std::string& extra, char colour_type = 0) {
  std::string header = grey_png.substr(16, 13);
  header[9] = colour_type;
  return grey_png.substr(0, 8) + png_chunk("IHDR", header) + extra + grey_png.substr(33);
}

class LoadTest : public ::testing::Test {
 protected:
  std::string file(const std::string& bytes) { return test::write_file(scratch_.path() / "picture", bytes); }
  std::string refusal(const std::string& path) {
    return test::message_of([&] { load_gray(path); });
  }
  // The message about a file with these bytes, without the path, which must come first.
  std::string refusal_of_bytes(const std::string& bytes) {
    const std::string path = file(bytes);
    ::testing::internal::CaptureStderr();
    const std::string message = refusal(path);
    EXPECT_EQ(::testing::internal::GetCapturedStderr(), "") << "decoders keep quiet";
    EXPECT_EQ(message.substr(0, path.size() + 4), "'" + path + "': ");
    return message.substr(std::min(message.size(), path.size() + 4));
  }

  test::ScratchFolder scratch_;
};

TEST_F(LoadTest, TakesGreyAsStoredInEveryLosslessFormat) {
  const cv::Mat picture = noise(CV_8UC1);
  for (const char* extension : {".png", ".bmp", ".pgm", ".tiff", ".pam"}) {
    const LoadedGray loaded = load_gray(file(encoded(extension, picture)));
    EXPECT_FALSE(loaded.converted_from_colour) << extension;
    EXPECT_EQ(loaded.image.width, kWidth);
    EXPECT_EQ(loaded.image.height, kHeight);
    EXPECT_EQ(loaded.image.pixels, pixels_of(picture)) << extension;
  }
}

TEST_F(LoadTest, TakesAJpegAsOpenCVDecodesIt) {
  std::vector<std::string> jpegs;
  for (const int type : {CV_8UC1, CV_8UC3}) {
    for (const int progressive : {0, 1})
      jpegs.push_back(encoded(".jpg", noise(type), {cv::IMWRITE_JPEG_PROGRESSIVE, progressive}));
  }
  for (const std::string& bytes : jpegs) {
    const cv::Mat expected = cv::imread(file(bytes), cv::IMREAD_UNCHANGED);
    const bool is_grey = expected.channels() == 1;
    for (const char* end : {"", "appended"}) {
      EXPECT_EQ(load_gray(file(bytes + end)).image.pixels,
                is_grey ? pixels_of(expected) : grey_pixels_of(expected));
    }
  }
}

TEST_F(LoadTest, ConvertsColourWithBgr2Gray) {
  const cv::Mat picture = noise(CV_8UC3);
  for (const char* extension : {".png", ".bmp", ".ppm", ".tiff"}) {
    const LoadedGray loaded = load_gray(file(encoded(extension, picture)));
    EXPECT_TRUE(loaded.converted_from_colour) << extension;
    EXPECT_EQ(loaded.image.pixels, grey_pixels_of(picture)) << extension;
  }
}

TEST_F(LoadTest, TakesAPaletteAsColour) {
  std::string palette;
  std::string greys;
  for (int i = 0; i < 256; ++i) {
    palette += std::string{static_cast<char>(i), '\0', static_cast<char>(255 - i)};
    greys += std::string(3, static_cast<char>(i));
  }
  const cv::Mat picture = noise(CV_8UC1);
  const std::string png = encoded(".png", picture);
  const LoadedGray loaded = load_gray(file(png_with(png, png_chunk("PLTE", palette), 3)));
  EXPECT_TRUE(loaded.converted_from_colour);
  cv::Mat colours(picture.size(), CV_8UC3);
  std::transform(
      picture.begin<std::uint8_t>(), picture.end<std::uint8_t>(), colours.begin<cv::Vec3b>(),
      [](std::uint8_t level) { return cv::Vec3b(static_cast<std::uint8_t>(255 - level), 0, level); });
  EXPECT_EQ(loaded.image.pixels, grey_pixels_of(colours));

  const LoadedGray of_greys = load_gray(file(png_with(png, png_chunk("PLTE", greys), 3)));
  EXPECT_TRUE(of_greys.converted_from_colour);
  EXPECT_EQ(of_greys.image.pixels, pixels_of(picture)) << "greys are their own grey";
}

TEST_F(LoadTest, DoesNotTurnByExifOrientation) {
  // APP1 with one big-endian directory entry: orientation (0x0112) = 6, turn by 90 degrees.
  const std::string exif(
      "\xFF\xE1\x00\x22"
      "Exif\0\0MM\0\x2A\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0\0\0\0\0",
      36);
  const std::string jpeg = encoded(".jpg", noise(CV_8UC1));
  const std::string path = file(jpeg.substr(0, 2) + exif + jpeg.substr(2));
  ASSERT_EQ(cv::imread(path, cv::IMREAD_GRAYSCALE).size(), cv::Size(kHeight, kWidth))
      << "OpenCV's default turns";
  EXPECT_EQ(load_gray(path).image.width, kWidth);
  EXPECT_EQ(load_gray(path).image.pixels, load_gray(file(jpeg)).image.pixels);
}

TEST_F(LoadTest, RefusesPixelsThatAreNotEightBitGreyOrColour) {
  const std::string png = encoded(".png", noise(CV_8UC1));
  const std::string palette = png_chunk("PLTE", std::string(768, 'p'));
  const std::vector<std::pair<std::string, std::string>> refused = {
      {png_with(png, png_chunk("tRNS", std::string(2, '\0'))), "transparent"},
      {png_with(png, palette + png_chunk("tRNS", "tr"), 3), "transparent"},
      {encoded(".png", noise(CV_16UC1)), "16-bit grey: "},
      {encoded(".tiff", noise(CV_16UC1)), "16-bit grey: "},
      {encoded(".pgm", noise(CV_16UC1)), "a maximum level of 65535: "},
      {encoded(".png", noise(CV_16UC3)), "16-bit colour: "},
      {encoded(".tiff", noise(CV_32FC1)), "float grey: "},
      {encoded(".pfm", noise(CV_32FC1)), "float grey: "},
      // OpenCV would stretch these greys, and would read the raster as black.
      {encoded(".png", noise(CV_8UC1), {cv::IMWRITE_PNG_BILEVEL, 1}), "1-bit grey"},
      {"P2\n2 1\n100\n0 50\n", "a maximum level of 100: "},
      {"P5\n# 255\n2 1\n254\nab", "a maximum level of 254: "},
      {"P1\n4 1\n0 1 1 0\n", "1-bit black and white"},
      {"P7\nWIDTH 2\nHEIGHT 1\nDEPTH 1\nMAXVAL 15\nTUPLTYPE GRAYSCALE\nENDHDR\nab",
       "a maximum level of 15: "},
      {encoded(".ras", noise(CV_8UC1)), "a Sun raster without colour map: "},
      {"", "an empty file: "},
      {"x", "not a picture in a format that is read: a picture must be PNG, "},
      {std::string(5000, 't'), "not a picture in a format that is read: a picture must be PNG, "}};
  for (const auto& [bytes, message] : refused) EXPECT_THAT(refusal_of_bytes(bytes), HasSubstr(message));
  EXPECT_EQ(load_gray(file("P5\n# 100\n2 1\n255\nab")).image.pixels, (std::vector<std::uint8_t>{'a', 'b'}));
  EXPECT_EQ(load_gray(file("P5\r\n2 1\r\n255\r\nab")).image.pixels, (std::vector<std::uint8_t>{'a', 'b'}));
  EXPECT_EQ(load_gray(file("P2\n2 1\n255\n0 50\n")).image.pixels, (std::vector<std::uint8_t>{0, 50}));
  EXPECT_TRUE(load_gray(file(encoded(".ras", noise(CV_8UC3)))).converted_from_colour);
}

TEST_F(LoadTest, RefusesAPathThatIsNotAReadableFile) {
  const std::string missing = scratch_.path() / "missing.png";
  EXPECT_EQ(refusal(missing), "'" + missing + "': no such file");
  EXPECT_THAT(refusal(scratch_.path()), HasSubstr("': must be a regular file"));
}

// Every prefix of a file either lacks pixels, and is refused, or holds them all, and gives the same picture.
TEST_F(LoadTest, RefusesATruncatedFileOfAnyFormat) {
  struct Format {
    const char* extension;
    std::vector<int> parameters;
    std::size_t
        bytes_without_pixels;  // at the end: a part of a tag that says nothing; of a text, its last number
  };
  const std::vector<Format> formats = {{".png", {}, 0},
                                       {".jpg", {}, 0},
                                       {".jpg", {cv::IMWRITE_JPEG_PROGRESSIVE, 1}, 0},
                                       {".bmp", {}, 0},
                                       {".ppm", {}, 0},
                                       {".ppm", {cv::IMWRITE_PXM_BINARY, 0}, 4},
                                       {".tiff", {}, 4},
                                       {".tiff", {cv::IMWRITE_TIFF_COMPRESSION, 1}, 4},
                                       {".webp", {}, 0},
                                       {".jp2", {}, 0}};
  for (const Format& format : formats) {
    for (const int type : {CV_8UC1, CV_8UC3}) {
      const char* extension =
          type == CV_8UC1 && std::strcmp(format.extension, ".ppm") == 0 ? ".pgm" : format.extension;
      const std::string whole = encoded(extension, noise(type), format.parameters);
      const LoadedGray expected = load_gray(file(whole));
      const std::size_t step = std::max<std::size_t>(1, whole.size() / 25);
      for (std::size_t size = whole.size() - 1; size > 0;
           size -= std::min(size, size + 30 > whole.size() ? 1 : step)) {
        if (size + format.bytes_without_pixels >= whole.size()) {
          LoadedGray loaded;
          try {
            loaded = load_gray(file(whole.substr(0, size)));
          } catch (const std::runtime_error&) {
            continue;
          }
          ASSERT_EQ(loaded.image.pixels.size(), expected.image.pixels.size());
          EXPECT_TRUE(std::equal(loaded.image.pixels.begin(), loaded.image.pixels.end() - 1,
                                 expected.image.pixels.begin()))
              << extension << ' ' << size;
        } else {
          EXPECT_NE(refusal_of_bytes(whole.substr(0, size)), "")
              << extension << ' ' << size << " of " << whole.size();
        }
      }
    }
  }
}

TEST_F(LoadTest, RefusesDamagedFiles) {
  cv::Mat large(200, 200, CV_8UC1);
  cv::RNG(3).fill(large, cv::RNG::UNIFORM, 0, 256);
  for (const char* extension : {".png", ".jpg", ".bmp"}) {
    std::string cut = encoded(extension, large);
    cut.pop_back();
    EXPECT_EQ(refusal_of_bytes(cut), "truncated or damaged: a picture must be complete") << extension;
  }
  std::string jpeg = encoded(".jpg", large);
  EXPECT_THAT(refusal_of_bytes(std::string(jpeg).erase(jpeg.size() / 2, 500)), HasSubstr("a damaged JPEG"));
  EXPECT_THAT(refusal_of_bytes(jpeg.replace(jpeg.size() / 2, 2, "\xFF\xD9")), HasSubstr("a damaged JPEG"));
  std::string png = encoded(".png", large);
  png[png.size() / 2] = static_cast<char>(png[png.size() / 2] ^ 1);
  EXPECT_THAT(refusal_of_bytes(png), HasSubstr("damaged"));
}

TEST_F(LoadTest, RefusesAPictureWhoseHeaderExceedsABoardsImages) {
  struct Format {
    const char* extension;
    std::vector<int> parameters;
    int type = CV_8UC1;
  };
  const std::string rule = " pixels: a board's images are 8192x8192 at most";
  for (const Format& format : {Format{".png", {}},
                               {".jpg", {}},
                               {".jpg", {cv::IMWRITE_JPEG_PROGRESSIVE, 1}},
                               {".pgm", {}},
                               {".ppm", {cv::IMWRITE_PXM_BINARY, 0}, CV_8UC3},
                               {".pam", {}},
                               {".bmp", {}},
                               {".tiff", {}},
                               {".webp", {}, CV_8UC3},
                               {".jp2", {}},
                               {".ras", {}, CV_8UC3}}) {
    const auto bytes = [&format](int width, int height) {
      return encoded(format.extension, cv::Mat(height, width, format.type, cv::Scalar::all(99)),
                     format.parameters);
    };
    EXPECT_EQ(refusal_of_bytes(bytes(8193, 32)), "8193x32" + rule) << format.extension;
    EXPECT_EQ(refusal_of_bytes(bytes(32, 8193)), "32x8193" + rule) << format.extension;
    EXPECT_EQ(load_gray(file(bytes(8192, 32))).image.width, 8192) << format.extension;
    EXPECT_EQ(load_gray(file(bytes(32, 8192))).image.height, 8192) << format.extension;
  }
}

// The pixels of these pictures would take gigabytes.
TEST_F(LoadTest, DecodesNothingOfAPictureThatIsTooLarge) {
  const std::string png = encoded(".png", noise(CV_8UC1));
  std::string header = png.substr(16, 13);
  header.replace(0, 8, std::string("\0\0\xFF\0\0\0\xFF\0", 8));
  EXPECT_THAT(refusal_of_bytes(png.substr(0, 8) + png_chunk("IHDR", header) + png.substr(33)),
              HasSubstr("65280x65280 pixels: "));
  std::string jpeg = encoded(".jpg", noise(CV_8UC1));
  jpeg.replace(jpeg.find("\xFF\xC0") + 5, 4, "\xFF\x10\xFF\x20");
  EXPECT_THAT(refusal_of_bytes(jpeg), HasSubstr("65312x65296 pixels: "));
  EXPECT_THAT(refusal_of_bytes(std::string("P5\n# 1 1\n99999999999 1\n255\n") + "x"),
              HasSubstr("1000000000x1 pixels: "));
}

TEST_F(LoadTest, DecodesAHundredScansOfAJpegAtMost) {
  const std::string jpeg = encoded(".jpg", noise(CV_8UC1), {cv::IMWRITE_JPEG_PROGRESSIVE, 1});
  const std::size_t last = jpeg.rfind("\xFF\xDA");
  int scans = 0;
  for (std::size_t at = jpeg.find("\xFF\xDA"); at != std::string::npos; at = jpeg.find("\xFF\xDA", at + 1))
    ++scans;
  const auto with_scans = [&](int number) {
    std::string more = jpeg;
    for (; number > scans; --number) more.insert(last, jpeg, last, jpeg.size() - 2 - last);
    return more;
  };
  EXPECT_NO_THROW(load_gray(file(with_scans(100))));
  EXPECT_EQ(refusal_of_bytes(with_scans(101)), "101 scans: a JPEG must have 100 at most");
}

TEST_F(LoadTest, ReadsNothingOfAFileThatIsTooLong) {
  const std::string path = file("P5\n2 1\n255\nab");
  fs::resize_file(path, 16 * 2048 * 2048);
  EXPECT_NO_THROW(load_gray(path));
  fs::resize_file(path, 16 * 8192 * 8192 + 1);
  EXPECT_EQ(refusal(path), "'" + path + "': 1073741825 bytes: must be 1073741824 at most");
}

TEST_F(LoadTest, LoadsTruthAsGreyWithAPositiveScale) {
  const cv::Mat picture = noise(CV_8UC1);
  const std::string path = file(encoded(".png", picture));
  const Truth truth = load_truth(path, 2.5);
  const std::vector<std::uint8_t> pixels = pixels_of(picture);
  std::vector<float> expected(pixels.begin(), pixels.end());
  std::replace(expected.begin(), expected.end(), 0.0F, Truth::kUnknown);
  EXPECT_EQ(truth.levels, expected);
  EXPECT_EQ(truth.width, kWidth);
  EXPECT_EQ(truth.scale, 2.5);
  EXPECT_NO_THROW(load_truth(path, 1e-3));
  for (const double scale : {0.0, -1.0, std::nan(""), HUGE_VAL})
    EXPECT_THROW(load_truth(path, scale), std::invalid_argument) << scale;
  const auto refused = [this](int type) {
    const std::string other = file(encoded(".png", noise(type)));
    return test::message_of([&] { load_truth(other, 1); });
  };
  EXPECT_THAT(refused(CV_8UC3), HasSubstr("': 8-bit colour: ground truth must be grey"));
  EXPECT_THAT(refused(CV_16UC3), HasSubstr("': 16-bit colour: "));
}

TEST_F(LoadTest, LoadsTruthOfKittiAndMiddlebury) {
  const std::string path = file(encoded(".png", cv::Mat(1, 3, CV_16UC1, cv::Scalar(20 * 256 + 128))));
  EXPECT_EQ(load_truth(path, 256).levels, (std::vector<float>{5248, 5248, 5248}));
  EXPECT_THAT(test::message_of([&] { load_truth(path, {}); }),
              HasSubstr("16-bit grey: its scale must be given"));
  // Rows from the bottom up: 1.5 and infinite below, 20 and 0 above.
  const auto pfm = [](const std::string& order, bool is_little) {
    std::string text = "Pf\n2 2\n" + order + "\n";
    for (const float level : {1.5F, std::numeric_limits<float>::infinity(), 20.0F, 0.0F}) {
      std::string bytes(4, ' ');
      std::memcpy(bytes.data(), &level, 4);
      text += is_little ? bytes : std::string(bytes.rbegin(), bytes.rend());
    }
    return text;
  };
  for (const std::string& bytes : {pfm("-1.0", true), pfm("1", false)}) {
    const Truth truth = load_truth(file(bytes), {});
    EXPECT_EQ(truth.levels, (std::vector<float>{20, Truth::kUnknown, 1.5F, Truth::kUnknown}));
    EXPECT_EQ(truth.scale, 1);
    EXPECT_EQ(load_truth(file(bytes), 256).scale, 256);
    EXPECT_EQ(load_truth("none", {}, &bytes).levels, truth.levels);
    EXPECT_THAT(test::message_of([&] { load_truth(file(bytes.substr(0, bytes.size() - 1)), {}); }),
                HasSubstr("truncated or damaged"));
  }
}

TEST(Truth, NeedsTheLargestDisparityRoundedUpAndZero) {
  Truth truth(kernels::GrayImage(2, 1), 2);
  EXPECT_EQ(disparities_needed(truth), 1);
  truth.levels[1] = 158;
  EXPECT_EQ(disparities_needed(truth), 80);
  truth.levels[0] = 159;
  EXPECT_EQ(disparities_needed(truth), 81);
  truth.scale = 1.5;
  EXPECT_EQ(disparities_needed(truth), 107);
  truth.scale = 1e-300;
  EXPECT_GT(disparities_needed(truth), 1e300);
}

}  // namespace
}  // namespace stereotlm::media
