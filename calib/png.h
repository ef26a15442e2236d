#pragma once

#include <cstdint>
#include <vector>

namespace stereotlm::calib {

// The values of a pixel of a PNG.
enum class PngPixel : std::uint8_t { kGrey, kGrey16, kColour };  // colour: 8 bits each of blue, green, red

// PNG bytes of a picture, whose pixels follow each other row by row, without gaps. The same picture gives the
// same bytes, which are those of OpenCV 4.6. Throws std::runtime_error if libpng fails.
std::vector<std::uint8_t> encode_png(int width, int height, PngPixel pixel, const void* pixels);

}  // namespace stereotlm::calib
