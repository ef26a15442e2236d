#include "sw/media/picture_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <system_error>
#include <vector>

#include "models/fpga/core_config.h"
#include "sw/media/captured_stderr.h"
#include "sw/media/media_errors.h"
#include "sw/media/picture_header.h"

namespace stereotlm::media {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr const char* kRule = "a picture must be 8-bit grey or 8-bit colour, without alpha";

// The largest file that is read: enough for the largest picture of a board with its pixels as text, or in
// colour with much metadata.
constexpr std::uintmax_t kMostBytes = 16 * fpga::kWidthRule.max * fpga::kHeightRule.max;

Bytes read_bytes(const std::string& path) {
  constexpr const char* kFileRule = "a picture must be a readable regular file";
  check_regular_file(path, kFileRule);
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) throw_media_error(path, error.message(), kFileRule);
  if (size > kMostBytes)
    throw_media_error(path, fmt::format("{} bytes", size),
                      fmt::format("a picture must have {} at most", kMostBytes));
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), &std::fclose);
  if (!file) throw_media_error(path, std::strerror(errno), kFileRule);
  Bytes bytes;
  std::uint8_t buffer[1 << 16];
  std::size_t count = 0;
  while ((count = std::fread(buffer, 1, sizeof buffer, file.get())) > 0) {
    bytes.insert(bytes.end(), buffer, buffer + count);
  }
  if (std::ferror(file.get()) != 0) throw_media_error(path, std::strerror(errno), kFileRule);
  if (bytes.empty()) throw_media_error(path, "an empty file", kRule);
  return bytes;
}

bool starts_with(const Bytes& bytes, const std::string& text) {
  return bytes.size() >= text.size() && std::memcmp(bytes.data(), text.data(), text.size()) == 0;
}

struct JpegSegments {
  int scans = 0;
  bool is_complete = false;  // the file has an end-of-image marker
};

// Counts the scans of a JPEG and finds its end. OpenCV 4.6 silently fills the missing part of a truncated
// sequential JPEG; it reports the truncation of every other format when it decodes from memory.
JpegSegments jpeg_segments(const Bytes& bytes) {
  JpegSegments found;
  std::size_t at = 2;  // after the start-of-image marker
  while (at + 1 < bytes.size()) {
    const int marker = bytes[at + 1];
    const bool at_marker = bytes[at] == 0xFF && marker != 0x00 && marker != 0xFF;
    const bool without_length = marker == 0x01 || (marker >= 0xD0 && marker <= 0xD8);
    if (!at_marker) {
      at += 1;
    } else if (without_length) {
      at += 2;
    } else if (marker == 0xD9) {
      found.is_complete = true;
      return found;
    } else {
      if (at + 3 >= bytes.size()) return found;
      if (marker == 0xDA) ++found.scans;
      at += 2U + (static_cast<std::size_t>(bytes[at + 2]) << 8U | bytes[at + 3]);
    }
  }
  return found;
}

bool png_has_chunk(const Bytes& bytes, const char* type) {
  std::size_t at = 8;  // after the signature
  while (at + 8 <= bytes.size()) {
    if (std::memcmp(&bytes[at + 4], type, 4) == 0) return true;
    at += 12U + (static_cast<std::size_t>(bytes[at]) << 24U | static_cast<std::size_t>(bytes[at + 1]) << 16U |
                 static_cast<std::size_t>(bytes[at + 2]) << 8U | bytes[at + 3]);
  }
  return false;
}

// Limit for the scans of a progressive JPEG. Encoders make about a dozen. Decoding a scan takes a pass over
// all pixels, even if the scan is empty.
constexpr int kMostScans = 100;

// Checks the size before decoding: OpenCV allocates whatever size a header states.
void check_size(const std::string& path, const std::optional<PictureSize>& size) {
  if (!size) throw_media_error(path, "truncated or damaged in its header", "a picture must be complete");
  const auto width = static_cast<std::uint64_t>(fpga::kWidthRule.max);
  const auto height = static_cast<std::uint64_t>(fpga::kHeightRule.max);
  if (size->width <= width && size->height <= height) return;
  throw_media_error(path, fmt::format("{}x{} pixels", size->width, size->height),
                    fmt::format("a board's images are {}x{} at most", width, height));
}

// Refuses files that OpenCV would not decode as stored: without notice it stretches levels, drops
// transparency, and reads some greys as black.
void check_stored_form(const std::string& path, const Bytes& bytes) {
  constexpr std::size_t kPngDepth = 24;
  constexpr std::size_t kPngColourType = 25;
  if (starts_with(bytes, "\x89PNG") && bytes.size() > kPngColourType) {
    if (png_has_chunk(bytes, "tRNS")) throw_media_error(path, "a PNG with transparency (tRNS)", kRule);
    if (bytes[kPngColourType] == 0 && bytes[kPngDepth] < 8) {
      throw_media_error(path, fmt::format("{}-bit grey", bytes[kPngDepth]), kRule);
    }
  }
  constexpr std::size_t kRasDepth = 15;
  constexpr std::size_t kRasMapLength = 28;
  if (starts_with(bytes, "\x59\xA6\x6A\x95") && bytes.size() > kRasMapLength + 4 && bytes[kRasDepth] == 8 &&
      std::all_of(&bytes[kRasMapLength], &bytes[kRasMapLength + 4],
                  [](std::uint8_t byte) { return byte == 0; })) {
    throw_media_error(path, "a Sun raster without colour map", "OpenCV 4.6 reads it as black");
  }
  const bool is_pnm = bytes.size() > 2 && bytes[0] == 'P' && std::isspace(bytes[2]) != 0;
  if (is_pnm && (bytes[1] == '1' || bytes[1] == '4')) throw_media_error(path, "1-bit black and white", kRule);
  if (is_pnm && bytes[1] >= '2' && bytes[1] <= '7') {
    const auto maximum = bytes[1] == '7' ? pam_number(bytes, "MAXVAL") : pnm_number(bytes, 2);
    if (maximum && *maximum != 255) {
      throw_media_error(path, fmt::format("a maximum level of {}", *maximum),
                        "a PGM, PPM or PAM must state 255");
    }
  }
}

std::string description(const cv::Mat& picture) {
  static constexpr const char* kDepths[] = {"8-bit",  "signed 8-bit", "16-bit", "signed 16-bit",
                                            "32-bit", "float",        "double", "half float"};
  const int channels = picture.channels();
  const char* kind = channels == 1   ? "grey"
                     : channels == 3 ? "colour"
                     : channels == 2 ? "grey with alpha"
                                     : "colour with alpha";
  return fmt::format("{} {}", kDepths[picture.depth()], kind);
}

}  // namespace

cv::Mat read_picture(const std::string& path) {
  const Bytes bytes = read_bytes(path);
  const std::optional<PictureHeader> header = read_header(bytes);
  if (!header) {
    throw_media_error(path, "not a picture in a format that is read",
                      fmt::format("a picture must be {}", kPictureFormats));
  }
  check_size(path, header->size);
  const JpegSegments jpeg = header->is_jpeg ? jpeg_segments(bytes) : JpegSegments{1, true};
  if (jpeg.scans > kMostScans) {
    throw_media_error(path, fmt::format("{} scans", jpeg.scans),
                      fmt::format("a JPEG must have {} at most", kMostScans));
  }
  cv::Mat picture;
  std::string complaint;
  {
    CapturedStderr captured;
    try {
      picture = cv::imdecode(bytes, cv::IMREAD_UNCHANGED);
    } catch (const cv::Exception&) {
      picture.release();
    }
    complaint = captured.text();
  }
  if (picture.empty() || !jpeg.is_complete) {
    throw_media_error(path, "truncated or damaged", "a picture must be complete");
  }
  // libjpeg only warns: it fills damaged scan data with grey and continues.
  if (header->is_jpeg && complaint.find("Corrupt JPEG data") != std::string::npos) {
    throw_media_error(path, "a damaged JPEG", "a picture must be complete");
  }
  if (picture.depth() != CV_8U || (picture.channels() != 1 && picture.channels() != 3)) {
    throw_media_error(path, description(picture), kRule);
  }
  check_stored_form(path, bytes);
  return picture;
}

}  // namespace stereotlm::media
