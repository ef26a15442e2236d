#include "sw/media/decode.h"

#include <jpeglib.h>
#include <png.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <cstdio>  // before jpeglib.h, which needs it
#include <cstring>
#include <utility>

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

// Limit for the scans of a progressive JPEG. Encoders make about a dozen. Decoding a scan takes a pass over
// all pixels, even if the scan is empty.
constexpr int kMostScans = 100;

[[noreturn]] void fail_jpeg(j_common_ptr /*info*/) { refuse_damaged(); }

// libjpeg fills damaged parts with grey, and continues with a warning. The first warning counts: a scan that
// repeats an earlier one is unusual, but not damaged, and leads to more warnings.
void check_jpeg_warning(j_common_ptr info, int level) {
  if (level >= 0) return;
  char text[JMSG_LENGTH_MAX];
  info->err->format_message(info, text);
  const std::string_view message = text;
  if (message.rfind("Premature end", 0) == 0) refuse_damaged();
  // Bytes between two segments belong to none. Those before the end of the picture may be a part of it.
  const bool is_stray = message.find("extraneous bytes before marker") != std::string_view::npos;
  if (is_stray && message.find("0xd9") == std::string_view::npos) {
    static_cast<Picture*>(info->client_data)
        ->notes.push_back(std::string(message.substr(message.find(':') + 2)) + " are left out");
    return;
  }
  if (info->err->num_warnings++ == 0 && message.rfind("Corrupt JPEG data", 0) == 0)
    refuse_picture("a damaged JPEG", "a picture must be complete");
}

void check_scans(j_common_ptr info) {
  const int scans = reinterpret_cast<j_decompress_ptr>(info)->input_scan_number;
  if (scans > kMostScans)
    refuse_picture(fmt::format("{} scans", scans), fmt::format("a JPEG must have {} at most", kMostScans));
}

struct JpegReader {
  JpegReader() {
    info.err = jpeg_std_error(&errors);
    errors.error_exit = fail_jpeg;
    errors.emit_message = check_jpeg_warning;
    jpeg_create_decompress(&info);
    progress.progress_monitor = check_scans;
    info.progress = &progress;
  }
  ~JpegReader() { jpeg_destroy_decompress(&info); }
  JpegReader(const JpegReader&) = delete;
  JpegReader& operator=(const JpegReader&) = delete;

  jpeg_decompress_struct info = {};
  jpeg_error_mgr errors = {};
  jpeg_progress_mgr progress = {};
};

bool is_space(char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; }

class Words {
 public:
  explicit Words(std::string_view bytes) : rest_(bytes) {}

  // The next word, without comments before it. Takes the one byte of white space behind it.
  std::string_view next() {
    while (!rest_.empty() && (is_space(rest_[0]) || rest_[0] == '#')) {
      const bool is_comment = rest_[0] == '#';
      rest_.remove_prefix(is_comment ? std::min(rest_.find_first_of("\r\n"), rest_.size()) : 1);
    }
    const auto end = std::find_if(rest_.begin(), rest_.end(), [](char c) { return is_space(c) || c == '#'; });
    if (end == rest_.begin()) refuse_damaged();
    const std::string_view word = rest_.substr(0, static_cast<std::size_t>(end - rest_.begin()));
    rest_.remove_prefix(word.size() + (end != rest_.end() && *end != '#' ? 1 : 0));
    return word;
  }
  // The next word as a number, at most 1,000,000,000.
  std::uint64_t number() {
    constexpr std::uint64_t kMost = 1'000'000'000;
    std::uint64_t number = 0;
    for (const char digit : next()) {
      if (digit < '0' || digit > '9') refuse_damaged();
      number = std::min(kMost, number * 10 + static_cast<std::uint64_t>(digit - '0'));
    }
    return number;
  }
  std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
};

struct PnmHeader {
  std::uint64_t width = 0;
  std::uint64_t height = 0;
  std::uint64_t channels = 0;
  std::uint64_t maximum = 0;
};

PnmHeader pam_header(Words& words) {
  PnmHeader header;
  for (std::string_view field = words.next(); field != "ENDHDR"; field = words.next()) {
    if (field == "WIDTH") {
      header.width = words.number();
    } else if (field == "HEIGHT") {
      header.height = words.number();
    } else if (field == "DEPTH") {
      header.channels = words.number();
    } else if (field == "MAXVAL") {
      header.maximum = words.number();
    } else {
      words.next();  // the kind of pixels, which DEPTH says too
    }
  }
  return header;
}

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
  const bool is_palette = type == PNG_COLOR_TYPE_PALETTE;
  if (bits != 8 && !is_palette)
    refuse_picture(fmt::format("{}-bit {}", bits, is_colour ? "colour" : "grey"), kPixelRule);
  if (is_palette) png_set_palette_to_rgb(reader.png);
  const bool has_keys = png_get_valid(reader.png, reader.info, PNG_INFO_tRNS) != 0;
  if (has_keys) png_set_tRNS_to_alpha(reader.png);
  const bool has_alpha = has_keys || (type & PNG_COLOR_MASK_ALPHA) != 0;
  if (has_alpha) {
    picture.channels += 1;
    picture.samples.resize(picture.samples.size() / static_cast<std::size_t>(picture.channels - 1) *
                           static_cast<std::size_t>(picture.channels));
  }
  png_set_bgr(reader.png);
  png_set_interlace_handling(reader.png);
  png_read_update_info(reader.png, reader.info);
  std::vector<png_bytep> rows;
  const std::size_t row_bytes = picture.samples.size() / static_cast<std::size_t>(picture.height);
  for (std::size_t at = 0; at < picture.samples.size(); at += row_bytes) rows.push_back(&picture.samples[at]);
  png_read_image(reader.png, rows.data());
  png_read_end(reader.png, reader.info);
  if (has_alpha) drop_alpha(picture);
  png_bytep exif = nullptr;
  png_uint_32 exif_bytes = 0;
  if (png_get_eXIf_1(reader.png, reader.info, &exif_bytes, &exif) != 0)
    note_orientation({reinterpret_cast<const char*>(exif), exif_bytes}, picture);
  return picture;
}

bool is_deep_png(std::string_view bytes) {
  constexpr std::size_t kBits = 24;  // of the header, then the type of colour
  return bytes.size() > kBits + 1 && bytes[kBits] == 16 && bytes[kBits + 1] == PNG_COLOR_TYPE_GRAY;
}

Truth decode_deep_png(std::string_view bytes) {
  PngReader reader;
  png_set_read_fn(reader.png, &bytes, read_png);
  png_set_user_limits(reader.png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);  // new_picture() has the limits
  png_read_info(reader.png, reader.info);
  const Picture size = new_picture(png_get_image_width(reader.png, reader.info),
                                   png_get_image_height(reader.png, reader.info), 1);
  const auto width = static_cast<std::size_t>(size.width);
  const auto height = static_cast<std::size_t>(size.height);
  png_set_swap(reader.png);
  png_set_interlace_handling(reader.png);
  png_read_update_info(reader.png, reader.info);
  std::vector<std::uint16_t> levels(width * height);
  std::vector<png_bytep> rows;
  for (std::size_t y = 0; y < height; ++y) rows.push_back(reinterpret_cast<png_bytep>(&levels[y * width]));
  png_read_image(reader.png, rows.data());
  png_read_end(reader.png, nullptr);
  Truth truth(size.width, size.height);
  truth.set_levels(levels);
  return truth;
}

Truth decode_pfm(std::string_view bytes) {
  Words words(bytes.substr(2));
  const std::uint64_t width = words.number();
  const std::uint64_t height = words.number();
  const std::string_view order = words.next();  // a scale of brightness; its sign is the order of the bytes
  const Picture size = new_picture(width, height, 1);
  if (words.rest().size() < 4 * size.samples.size()) refuse_damaged();
  std::vector<float> levels(size.samples.size());
  for (std::uint64_t y = 0; y < height; ++y) {  // the last row comes first
    for (std::uint64_t x = 0; x < width; ++x) {
      std::array<char, 4> number{};
      words.rest().copy(number.data(), 4, 4 * ((height - 1 - y) * width + x));
      if (order[0] != '-') std::reverse(number.begin(), number.end());
      std::memcpy(&levels[y * width + x], number.data(), 4);
    }
  }
  Truth truth(size.width, size.height);
  truth.set_levels(levels);
  return truth;
}

Picture decode_jpeg(std::string_view bytes) {
  JpegReader reader;
  jpeg_decompress_struct& info = reader.info;
  jpeg_mem_src(&info, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
  constexpr int kExif = JPEG_APP0 + 1;
  constexpr unsigned kMostExif = 0xFFFF;
  jpeg_save_markers(&info, kExif, kMostExif);
  Picture picture;
  info.client_data = &picture;  // for the notes
  jpeg_read_header(&info, TRUE);
  const std::vector<std::string> notes = std::move(picture.notes);
  picture = new_picture(info.image_width, info.image_height, info.num_components == 1 ? 1 : 3);
  picture.notes = notes;
  if (info.num_components == 4) refuse_picture("CMYK", kPixelRule);
  info.out_color_space = info.num_components == 1 ? JCS_GRAYSCALE : JCS_EXT_BGR;
  for (jpeg_saved_marker_ptr marker = info.marker_list; marker != nullptr; marker = marker->next) {
    const std::string_view data(reinterpret_cast<const char*>(marker->data), marker->data_length);
    if (data.substr(0, 4) == "Exif" && data.size() > 6) note_orientation(data.substr(6), picture);
  }
  jpeg_start_decompress(&info);
  const std::size_t row_bytes = info.output_width * static_cast<std::size_t>(info.output_components);
  std::vector<std::uint8_t> row(row_bytes);
  picture.samples.clear();
  while (info.output_scanline < info.output_height) {
    JSAMPROW rows = row.data();
    jpeg_read_scanlines(&info, &rows, 1);
    picture.samples.insert(picture.samples.end(), row.begin(), row.end());
  }
  jpeg_finish_decompress(&info);
  return picture;
}

Picture decode_pnm(std::string_view bytes) {
  const char kind = bytes[1];
  if (kind == '1' || kind == '4') refuse_picture("1-bit black and white", kPixelRule);
  if (kind == 'f' || kind == 'F') refuse_picture(kind == 'f' ? "float grey" : "float colour", kPixelRule);
  Words words(bytes.substr(2));
  PnmHeader header;
  if (kind == '7') {
    header = pam_header(words);
  } else {
    header.width = words.number();
    header.height = words.number();
    header.maximum = words.number();
    header.channels = kind == '2' || kind == '5' ? 1 : 3;
  }
  if (header.channels < 1 || header.channels > 4)
    refuse_picture(fmt::format("a PAM of depth {}", header.channels), kPixelRule);
  Picture picture = new_picture(header.width, header.height, static_cast<int>(header.channels));
  if (header.maximum != 255) {
    refuse_picture(fmt::format("a maximum level of {}", header.maximum), "a PGM, PPM or PAM must state 255");
  }
  if (kind == '2' || kind == '3') {
    for (std::uint8_t& sample : picture.samples) {
      const std::uint64_t level = words.number();
      if (level > 255)
        refuse_picture(fmt::format("a sample of {}", level), "must be at most the maximum level, 255");
      sample = static_cast<std::uint8_t>(level);
    }
  } else {
    std::string_view rest = words.rest();
    // One byte of white space ends the header, or the two of a line's end in Windows.
    const char last = rest.data()[-1];
    if (last == '\r' && rest.size() == picture.samples.size() + 1 && rest[0] == '\n') rest.remove_prefix(1);
    if (rest.size() < picture.samples.size()) refuse_damaged();
    std::copy_n(rest.begin(), picture.samples.size(), picture.samples.begin());
  }
  if (picture.channels % 2 == 0) drop_alpha(picture);
  // The file has red first.
  for (std::size_t at = 0; picture.channels == 3 && at < picture.samples.size(); at += 3)
    std::swap(picture.samples[at], picture.samples[at + 2]);
  return picture;
}

}  // namespace stereotlm::media
