#include <fmt/format.h>
#include <jpeglib.h>

#include <cstddef>
#include <cstdio>  // before jpeglib.h, which needs it

#include "sw/media/decode.h"

namespace stereotlm::media {
namespace {

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

// As OpenCV 4.6 converts a pixel of cyan, magenta, yellow and black, which are stored inverted.
void append_of_cmyk(std::vector<std::uint8_t>& samples, const std::uint8_t* cmyk) {
  for (const int channel : {2, 1, 0})
    samples.push_back(static_cast<std::uint8_t>(cmyk[3] - ((255 - cmyk[channel]) * cmyk[3] >> 8)));
}

}  // namespace

Picture decode_jpeg(std::string_view bytes) {
  JpegReader reader;
  jpeg_decompress_struct& info = reader.info;
  jpeg_mem_src(&info, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
  jpeg_read_header(&info, TRUE);
  Picture picture = new_picture(info.image_width, info.image_height, info.num_components == 1 ? 1 : 3);
  const bool is_cmyk = info.num_components == 4;
  if (info.num_components == 1) {
    info.out_color_space = JCS_GRAYSCALE;
  } else {
    info.out_color_space = is_cmyk ? JCS_CMYK : JCS_EXT_BGR;
  }
  jpeg_start_decompress(&info);
  const std::size_t row_bytes = info.output_width * static_cast<std::size_t>(info.output_components);
  std::vector<std::uint8_t> row(row_bytes);
  picture.samples.clear();
  while (info.output_scanline < info.output_height) {
    JSAMPROW rows = row.data();
    jpeg_read_scanlines(&info, &rows, 1);
    if (!is_cmyk) picture.samples.insert(picture.samples.end(), row.begin(), row.end());
    for (std::size_t at = 0; is_cmyk && at < row_bytes; at += 4) append_of_cmyk(picture.samples, &row[at]);
  }
  jpeg_finish_decompress(&info);
  return picture;
}

}  // namespace stereotlm::media
