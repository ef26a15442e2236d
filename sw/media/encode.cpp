#include "sw/media/encode.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "calib/png.h"
#include "models/kernels/stereo.h"
#include "models/kernels/words.h"

namespace stereotlm::media {
namespace {

// The colour map Turbo (Anton Mikhailov, Google, 2019), as OpenCV has it: red, green, blue.
constexpr std::array<std::uint32_t, 256> kTurbo = {
    0x30123B, 0x321543, 0x33184A, 0x341B51, 0x351E58, 0x36215F, 0x372466, 0x38276D, 0x392A73, 0x3A2D79,
    0x3B2F80, 0x3C3286, 0x3D358B, 0x3E3891, 0x3F3B97, 0x3F3E9C, 0x4040A2, 0x4143A7, 0x4146AC, 0x4249B1,
    0x424BB5, 0x434EBA, 0x4451BF, 0x4454C3, 0x4456C7, 0x4559CB, 0x455CCF, 0x455ED3, 0x4661D6, 0x4664DA,
    0x4666DD, 0x4669E0, 0x466BE3, 0x476EE6, 0x4771E9, 0x4773EB, 0x4776EE, 0x4778F0, 0x477BF2, 0x467DF4,
    0x4680F6, 0x4682F8, 0x4685FA, 0x4687FB, 0x458AFC, 0x458CFD, 0x448FFE, 0x4391FE, 0x4294FF, 0x4196FF,
    0x4099FF, 0x3E9BFE, 0x3D9EFE, 0x3BA0FD, 0x3AA3FC, 0x38A5FB, 0x37A8FA, 0x35ABF8, 0x33ADF7, 0x31AFF5,
    0x2FB2F4, 0x2EB4F2, 0x2CB7F0, 0x2AB9EE, 0x28BCEB, 0x27BEE9, 0x25C0E7, 0x23C3E4, 0x22C5E2, 0x20C7DF,
    0x1FC9DD, 0x1ECBDA, 0x1CCDD8, 0x1BD0D5, 0x1AD2D2, 0x1AD4D0, 0x19D5CD, 0x18D7CA, 0x18D9C8, 0x18DBC5,
    0x18DDC2, 0x18DEC0, 0x18E0BD, 0x19E2BB, 0x19E3B9, 0x1AE4B6, 0x1CE6B4, 0x1DE7B2, 0x1FE9AF, 0x20EAAC,
    0x22EBAA, 0x25ECA7, 0x27EEA4, 0x2AEFA1, 0x2CF09E, 0x2FF19B, 0x32F298, 0x35F394, 0x38F491, 0x3CF58E,
    0x3FF68A, 0x43F787, 0x46F884, 0x4AF880, 0x4EF97D, 0x52FA7A, 0x55FA76, 0x59FB73, 0x5DFC6F, 0x61FC6C,
    0x65FD69, 0x69FD66, 0x6DFE62, 0x71FE5F, 0x75FE5C, 0x79FE59, 0x7DFF56, 0x80FF53, 0x84FF51, 0x88FF4E,
    0x8BFF4B, 0x8FFF49, 0x92FF47, 0x96FE44, 0x99FE42, 0x9CFE40, 0x9FFD3F, 0xA1FD3D, 0xA4FC3C, 0xA7FC3A,
    0xA9FB39, 0xACFB38, 0xAFFA37, 0xB1F936, 0xB4F836, 0xB7F735, 0xB9F635, 0xBCF534, 0xBEF434, 0xC1F334,
    0xC3F134, 0xC6F034, 0xC8EF34, 0xCBED34, 0xCDEC34, 0xD0EA34, 0xD2E935, 0xD4E735, 0xD7E535, 0xD9E436,
    0xDBE236, 0xDDE037, 0xDFDF37, 0xE1DD37, 0xE3DB38, 0xE5D938, 0xE7D739, 0xE9D539, 0xEBD339, 0xECD13A,
    0xEECF3A, 0xEFCD3A, 0xF1CB3A, 0xF2C93A, 0xF4C73A, 0xF5C53A, 0xF6C33A, 0xF7C13A, 0xF8BE39, 0xF9BC39,
    0xFABA39, 0xFBB838, 0xFBB637, 0xFCB336, 0xFCB136, 0xFDAE35, 0xFDAC34, 0xFEA933, 0xFEA732, 0xFEA431,
    0xFEA130, 0xFE9E2F, 0xFE9B2D, 0xFE992C, 0xFE962B, 0xFE932A, 0xFE9029, 0xFD8D27, 0xFD8A26, 0xFC8725,
    0xFC8423, 0xFB8122, 0xFB7E21, 0xFA7B1F, 0xF9781E, 0xF9751D, 0xF8721C, 0xF76F1A, 0xF66C19, 0xF56918,
    0xF46617, 0xF36315, 0xF26014, 0xF15D13, 0xF05B12, 0xEF5811, 0xED5510, 0xEC530F, 0xEB500E, 0xEA4E0D,
    0xE84B0C, 0xE7490C, 0xE5470B, 0xE4450A, 0xE2430A, 0xE14109, 0xDF3F08, 0xDD3D08, 0xDC3B07, 0xDA3907,
    0xD83706, 0xD63506, 0xD43305, 0xD23105, 0xD02F05, 0xCE2D04, 0xCC2B04, 0xCA2A04, 0xC82803, 0xC52603,
    0xC32503, 0xC12302, 0xBE2102, 0xBC2002, 0xB91E02, 0xB71D02, 0xB41B01, 0xB21A01, 0xAF1801, 0xAC1701,
    0xA91601, 0xA71401, 0xA41301, 0xA11201, 0x9E1001, 0x9B0F01, 0x980E01, 0x950D01, 0x920B01, 0x8E0A01,
    0x8B0902, 0x880802, 0x850702, 0x810602, 0x7E0502, 0x7A0403,
};

}  // namespace

std::vector<std::uint8_t> encode_png_gray(const kernels::GrayImage& image) {
  return calib::encode_png(image.width, image.height, calib::PngPixel::kGrey, image.pixels.data());
}

std::vector<std::uint8_t> encode_png_16(int width, int height, const std::vector<std::uint16_t>& values) {
  return calib::encode_png(width, height, calib::PngPixel::kGrey16, values.data());
}

std::vector<std::uint8_t> encode_disparity_color_png(const kernels::GrayImage& disparity, int disparities) {
  std::vector<std::uint8_t> colours;
  for (const std::uint8_t d : disparity.pixels) {
    const bool is_valid = d != kernels::kInvalidDisparity;
    const double level = is_valid && disparities > 1 ? 255.0 * d / (disparities - 1) : 0;
    const std::uint32_t colour = is_valid ? kTurbo.at(static_cast<std::size_t>(std::lround(level))) : 0;
    for (const unsigned shift : {0U, 8U, 16U}) colours.push_back(static_cast<std::uint8_t>(colour >> shift));
  }
  return calib::encode_png(disparity.width, disparity.height, calib::PngPixel::kColour, colours.data());
}

std::vector<std::uint8_t> encode_pfm(const kernels::GrayImage& disparity) {
  const std::string header = fmt::format("Pf\n{} {}\n-1.0\n", disparity.width, disparity.height);
  std::vector<std::uint8_t> bytes(header.begin(), header.end());
  bytes.reserve(bytes.size() + 4 * disparity.pixels.size());
  for (int y = disparity.height - 1; y >= 0; --y) {
    for (int x = 0; x < disparity.width; ++x) {
      const int d = disparity.at(x, y);
      const float value =
          d == kernels::kInvalidDisparity ? std::numeric_limits<float>::infinity() : static_cast<float>(d);
      std::uint32_t bits = 0;
      std::memcpy(&bits, &value, sizeof bits);
      for (unsigned shift = 0; shift < 32; shift += 8)
        bytes.push_back(static_cast<std::uint8_t>(bits >> shift));
    }
  }
  return bytes;
}

kernels::GrayImage nearest_disparity(const Truth& truth, int disparities) {
  kernels::GrayImage result(truth.grey.width, truth.grey.height, kernels::kInvalidDisparity);
  for (std::size_t i = 0; i < truth.grey.pixels.size(); ++i) {
    const double nearest = std::floor(truth.grey.pixels[i] / truth.scale + 0.5);
    if (truth.grey.pixels[i] != 0 && nearest < disparities)
      result.pixels[i] = static_cast<std::uint8_t>(nearest);
  }
  return result;
}

}  // namespace stereotlm::media
