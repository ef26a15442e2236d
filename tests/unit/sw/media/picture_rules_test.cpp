#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "sw/media/load.h"
#include "tests/support/scratch_folder.h"

// One rule for every format: opaque alpha is dropped, other alpha refused, an orientation ignored and said.
namespace stereotlm::media {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class PictureRules : public ::testing::Test {
 protected:
  LoadedGray load(const std::string& bytes) {
    return load_gray(test::write_file(scratch_.path() / "picture", bytes));
  }
  std::string refusal(const std::string& bytes) {
    return test::message_of([&] { load(bytes); });
  }

  test::ScratchFolder scratch_;
};

// A picture of 5 x 3 pixels, all of which have this alpha.
std::string with_alpha(const char* extension, std::uint8_t alpha) {
  cv::Mat picture(3, 5, CV_8UC4);
  cv::RNG(1).fill(picture, cv::RNG::UNIFORM, 0, 256);
  for (auto pixel = picture.begin<cv::Vec4b>(); pixel != picture.end<cv::Vec4b>(); ++pixel)
    (*pixel)[3] = alpha;
  std::vector<std::uint8_t> bytes;
  cv::imencode(extension, picture, bytes, {cv::IMWRITE_WEBP_QUALITY, 101});
  return {bytes.begin(), bytes.end()};
}

TEST_F(PictureRules, DropOpaqueAlphaAndRefuseOther) {
  const auto expected = load(with_alpha(".png", 255)).image.pixels;
  EXPECT_EQ(expected.size(), 15U);
  for (const char* const extension : {".png", ".tiff", ".webp", ".bmp"}) {
    EXPECT_EQ(load(with_alpha(extension, 255)).image.pixels, expected) << extension;
    EXPECT_THAT(refusal(with_alpha(extension, 200)), HasSubstr("without transparency")) << extension;
  }
  const std::string header = "P7\nWIDTH 1\nHEIGHT 1\nDEPTH 2\nMAXVAL 255\nTUPLTYPE GRAYSCALE_ALPHA\nENDHDR\n";
  EXPECT_THAT(load(header + "7\xFF").image.pixels, ElementsAre('7'));
  EXPECT_THAT(refusal(header + "7\xFE"), HasSubstr("1 pixels are transparent"));
}

// A little-endian TIFF of 2 x 1 grey pixels with these fields of one number.
std::string tiff(std::vector<std::pair<int, int>> fields, const std::string& pixels) {
  const auto words = [](std::initializer_list<int> values) {
    std::string text;
    for (const int value : values) text += {static_cast<char>(value & 255), static_cast<char>(value >> 8)};
    return text;
  };
  for (const auto& field : {std::pair(256, 2), {257, 1}, {259, 1}, {277, 1}, {278, 1}})
    fields.push_back(field);
  fields.emplace_back(273, 8);                                // where the pixels are
  fields.emplace_back(279, static_cast<int>(pixels.size()));  // their bytes
  std::sort(fields.begin(), fields.end());
  std::string file = "II*" + std::string(1, '\0') + words({10, 0}) + pixels;
  file.resize(10);
  file += words({static_cast<int>(fields.size())});
  for (const auto& [tag, value] : fields) file += words({tag, 3, 1, 0, value, 0});
  return file + words({0, 0});
}

TEST_F(PictureRules, IgnoreAnOrientationAndSayIt) {
  const LoadedGray turned = load(tiff({{258, 8}, {262, 1}, {274, 6}}, "ab"));
  EXPECT_EQ(turned.image.width, 2);
  EXPECT_THAT(turned.image.pixels, ElementsAre('a', 'b'));
  EXPECT_THAT(turned.notes, ElementsAre("its orientation 6 is ignored: read as stored"));
  EXPECT_THAT(load(tiff({{258, 8}, {262, 1}, {274, 1}}, "ab")).notes, IsEmpty());
}

TEST_F(PictureRules, RefuseInksAndBlackAndWhite) {
  EXPECT_THAT(refusal(tiff({{258, 8}, {262, 5}}, "ab")), HasSubstr("CMYK: a picture must be"));
  EXPECT_THAT(refusal(tiff({{258, 1}, {262, 1}}, "a")), HasSubstr("1-bit grey: a picture must be"));
}

TEST_F(PictureRules, TakeWhatIsCompleteAndRefuseWhatIsNot) {
  EXPECT_THAT(load("P2\n2# columns\n1\n255\n7 9").image.pixels, ElementsAre(7, 9));
  EXPECT_THAT(refusal("P2\n2 1\n255\n7 256\n"),
              HasSubstr("a sample of 256: must be at most the maximum level"));
  cv::Mat picture(64, 64, CV_8UC1);
  cv::RNG(2).fill(picture, cv::RNG::UNIFORM, 0, 256);
  std::vector<std::uint8_t> bytes;
  cv::imencode(".jpg", picture, bytes, {cv::IMWRITE_JPEG_RST_INTERVAL, 4});
  const std::string jpeg(bytes.begin(), bytes.end());
  for (const char* const marker : {"\xFF\xDB", "\xFF\xD3"}) {
    std::string stray = jpeg;
    stray.insert(stray.find(marker), 1, '\0');
    const LoadedGray found = load(stray);
    EXPECT_EQ(found.image.pixels, load(jpeg).image.pixels);
    ASSERT_EQ(found.notes.size(), 1U);
    EXPECT_THAT(found.notes[0], HasSubstr("1 extraneous bytes before marker 0xd"));
  }
}

}  // namespace
}  // namespace stereotlm::media
