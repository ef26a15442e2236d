#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <cstddef>

#include "sw/media/decode.h"

namespace stereotlm::media {
namespace {

// Debian builds libpng with the tables that an exception needs to pass through its functions.
[[noreturn]] void fail_png(png_structp /*png*/, const char* /*message*/) { refuse_damaged(); }
void ignore_png_warning(png_structp /*png*/, const char* /*message*/) {}

void read_png(png_structp png, png_bytep bytes, std::size_t count) {
  auto& rest = *static_cast<std::string_view*>(png_get_io_ptr(png));
  if (count > rest.size()) refuse_damaged();
  std::copy_n(rest.begin(), count, bytes);
  rest.remove_prefix(count);
}

struct PngReader {
  PngReader() : png(png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, fail_png, ignore_png_warning)) {
    info = png_create_info_struct(png);
  }
  ~PngReader() { png_destroy_read_struct(&png, &info, nullptr); }
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;

  png_structp png;
  png_infop info = nullptr;
};

}  // namespace

Picture decode_png(std::string_view bytes) {
  PngReader reader;
  png_set_read_fn(reader.png, &bytes, read_png);
  png_set_user_limits(reader.png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);  // new_picture() has the limits
  png_read_info(reader.png, reader.info);
  const int type = png_get_color_type(reader.png, reader.info);
  const int bits = png_get_bit_depth(reader.png, reader.info);
  const bool is_colour = (type & PNG_COLOR_MASK_COLOR) != 0;
  Picture picture = new_picture(png_get_image_width(reader.png, reader.info),
                                png_get_image_height(reader.png, reader.info), is_colour ? 3 : 1);
  if (png_get_valid(reader.png, reader.info, PNG_INFO_tRNS) != 0)
    refuse_picture("a PNG with transparency (tRNS)", kPixelRule);
  const bool has_alpha = (type & PNG_COLOR_MASK_ALPHA) != 0;
  const bool is_palette = type == PNG_COLOR_TYPE_PALETTE;
  if (has_alpha || (bits != 8 && !is_palette)) {
    refuse_picture(
        fmt::format("{}-bit {}{}", bits, is_colour ? "colour" : "grey", has_alpha ? " with alpha" : ""),
        kPixelRule);
  }
  if (is_palette) png_set_palette_to_rgb(reader.png);
  png_set_bgr(reader.png);
  png_set_interlace_handling(reader.png);
  png_read_update_info(reader.png, reader.info);
  std::vector<png_bytep> rows;
  const std::size_t row_bytes = picture.samples.size() / static_cast<std::size_t>(picture.height);
  for (std::size_t at = 0; at < picture.samples.size(); at += row_bytes) rows.push_back(&picture.samples[at]);
  png_read_image(reader.png, rows.data());
  png_read_end(reader.png, nullptr);
  return picture;
}

}  // namespace stereotlm::media
