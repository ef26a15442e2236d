#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "models/fpga/core_config.h"
#include "sw/media/load.h"

namespace stereotlm::media {

// Internal to this folder: the decoders of pictures. Each takes the bytes of a file, and decodes a picture as
// stored. Each throws std::runtime_error "what was found: rule" for a picture that is truncated, damaged,
// larger than a board's images, or of other pixels than 8-bit grey and colour.

inline constexpr const char* kPixelRule = "a picture must be 8-bit grey or 8-bit RGB";

struct Picture {
  int width = 0;     // pixels
  int height = 0;    // pixels
  int channels = 0;  // 1: grey; 3: blue, green, red
  std::vector<std::uint8_t> samples;
  std::vector<std::string> notes;  // what was read in another way than the file asks for
};

[[noreturn]] inline void refuse_picture(const std::string& found, const std::string& rule) {
  throw std::runtime_error(found + ": " + rule);
}
[[noreturn]] inline void refuse_damaged() {
  refuse_picture("truncated or damaged", "a picture must be complete");
}

// `size`: as in "8193x32".
[[noreturn]] inline void refuse_large(const std::string& size) {
  refuse_picture(size + " pixels", fmt::format("a board's images are {}x{} at most", fpga::kWidthRule.max,
                                               fpga::kHeightRule.max));
}

// A picture with room for its samples. Throws beyond a board's images, because a header may state any size.
inline Picture new_picture(std::uint64_t width, std::uint64_t height, int channels) {
  if (width == 0 || height == 0) refuse_damaged();
  if (width > fpga::kWidthRule.max || height > fpga::kHeightRule.max)
    refuse_large(fmt::format("{}x{}", width, height));
  return {static_cast<int>(width),
          static_cast<int>(height),
          channels,
          std::vector<std::uint8_t>(width * height * static_cast<std::uint64_t>(channels)),
          {}};
}

// Takes the alpha, which is the last sample of each pixel, from a picture. Refuses alpha that is not opaque.
void drop_alpha(Picture& picture);

// The value of a field with one number in the first directory of a TIFF, or of the Exif data of another
// format, which has the form of a TIFF. nullopt if it has none. `place`: where its bytes are.
std::optional<unsigned> tiff_field(std::string_view tiff, unsigned tag, std::size_t* place = nullptr);
// Adds a note if the Exif data of a picture ask for another orientation.
void note_orientation(std::string_view exif, Picture& picture);

Picture decode_png(std::string_view bytes);
// Whether the file is a PNG of 16-bit grey, for decode_deep_png().
bool is_deep_png(std::string_view bytes);
// Ground truth without its scale: of a PNG of 16-bit grey, and of a PFM of one channel.
Truth decode_deep_png(std::string_view bytes);
Truth decode_pfm(std::string_view bytes);
Picture decode_jpeg(std::string_view bytes);
// PGM, PPM and PAM.
Picture decode_pnm(std::string_view bytes);

// The functions that need the decoders of OpenCV. They are in a library that the first call of decoders()
// loads, because loading these decoders takes 100 ms.
struct Decoders {
  // Decodes BMP, TIFF, WebP, JPEG 2000 and Sun raster.
  Picture (*decode_picture)(std::string_view bytes);
  // See load.h.
  std::unique_ptr<Video> (*open_video)(const std::string& path, const VideoSizeCheck& check);
};

// Throws std::runtime_error if the library, which is installed with the program, cannot be loaded.
const Decoders& decoders();

}  // namespace stereotlm::media
