#include "calib/png.h"

#include <png.h>
#include <zlib.h>

#include <cstddef>
#include <stdexcept>
#include <string>

namespace stereotlm::calib {
namespace {

// Debian builds libpng with the tables that an exception needs to pass through its functions.
[[noreturn]] void fail(png_structp /*png*/, const char* message) {
  throw std::runtime_error(std::string("a picture could not be encoded as PNG: ") + message);
}

void append(png_structp png, png_bytep bytes, std::size_t count) {
  auto& file = *static_cast<std::vector<std::uint8_t>*>(png_get_io_ptr(png));
  file.insert(file.end(), bytes, bytes + count);
}

struct PngWriter {
  PngWriter() : png(png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, fail, nullptr)) {
    info = png_create_info_struct(png);
  }
  ~PngWriter() { png_destroy_write_struct(&png, &info); }
  PngWriter(const PngWriter&) = delete;
  PngWriter& operator=(const PngWriter&) = delete;

  png_structp png;
  png_infop info = nullptr;
};

}  // namespace

std::vector<std::uint8_t> encode_png(int width, int height, PngPixel pixel, const void* pixels) {
  const std::size_t bytes_per_pixel = pixel == PngPixel::kGrey ? 1 : pixel == PngPixel::kGrey16 ? 2 : 3;
  std::vector<std::uint8_t> file;
  PngWriter writer;
  png_set_write_fn(writer.png, &file, append, nullptr);
  png_set_filter(writer.png, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB);
  png_set_compression_level(writer.png, Z_BEST_SPEED);
  png_set_compression_strategy(writer.png, Z_RLE);
  png_set_IHDR(writer.png, writer.info, static_cast<png_uint_32>(width), static_cast<png_uint_32>(height),
               pixel == PngPixel::kGrey16 ? 16 : 8,
               pixel == PngPixel::kColour ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_write_info(writer.png, writer.info);
  png_set_bgr(writer.png);
  png_set_swap(writer.png);  // from little endian
  const auto* row = static_cast<const std::uint8_t*>(pixels);
  for (int y = 0; y < height; ++y, row += static_cast<std::size_t>(width) * bytes_per_pixel)
    png_write_row(writer.png, row);
  png_write_end(writer.png, writer.info);
  return file;
}

}  // namespace stereotlm::calib
