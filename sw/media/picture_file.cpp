#include "sw/media/picture_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "sw/media/captured_stderr.h"
#include "sw/media/media_file.h"

namespace stereotlm::media {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr const char* kRule = "a picture must be 8-bit grey or 8-bit colour, without alpha";

Bytes read_bytes(const std::string& path) {
  constexpr const char* kFileRule = "a picture must be a readable regular file";
  check_regular_file(path, kFileRule);
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), &std::fclose);
  if (!file) refuse(path, std::strerror(errno), kFileRule);
  Bytes bytes;
  std::uint8_t buffer[1 << 16];
  std::size_t count = 0;
  while ((count = std::fread(buffer, 1, sizeof buffer, file.get())) > 0) {
    bytes.insert(bytes.end(), buffer, buffer + count);
  }
  if (std::ferror(file.get()) != 0) refuse(path, std::strerror(errno), kFileRule);
  if (bytes.empty()) refuse(path, "an empty file", kRule);
  return bytes;
}

bool starts_with(const Bytes& bytes, const std::string& text) {
  return bytes.size() >= text.size() && std::memcmp(bytes.data(), text.data(), text.size()) == 0;
}

// Walks the segments to the end-of-image marker. OpenCV 4.6 fills what a truncated sequential JPEG lacks and
// reports nothing; every other format's truncation it notices when it decodes from memory.
bool jpeg_is_complete(const Bytes& bytes) {
  std::size_t at = 2;  // behind the start-of-image marker
  while (at + 1 < bytes.size()) {
    const int marker = bytes[at + 1];
    const bool at_marker = bytes[at] == 0xFF && marker != 0x00 && marker != 0xFF;
    const bool without_length = marker == 0x01 || (marker >= 0xD0 && marker <= 0xD8);
    if (!at_marker) {
      at += 1;
    } else if (without_length) {
      at += 2;
    } else if (marker == 0xD9) {
      return true;
    } else {
      if (at + 3 >= bytes.size()) return false;
      at += 2U + (static_cast<std::size_t>(bytes[at + 2]) << 8U | bytes[at + 3]);
    }
  }
  return false;
}

bool png_has_chunk(const Bytes& bytes, const char* type) {
  std::size_t at = 8;  // behind the signature
  while (at + 8 <= bytes.size()) {
    if (std::memcmp(&bytes[at + 4], type, 4) == 0) return true;
    at += 12U + (static_cast<std::size_t>(bytes[at]) << 24U | static_cast<std::size_t>(bytes[at + 1]) << 16U |
                 static_cast<std::size_t>(bytes[at + 2]) << 8U | bytes[at + 3]);
  }
  return false;
}

// The third number of a PGM or PPM header, where comments may stand between numbers; -1 if there is none.
int pnm_maximum(const Bytes& bytes) {
  std::size_t at = 2;
  int number = -1;
  for (int field = 0; field < 3; ++field) {
    while (at < bytes.size() && std::isdigit(bytes[at]) == 0) {
      if (bytes[at] == '#') {
        while (at < bytes.size() && bytes[at] != '\n') ++at;
      } else {
        ++at;
      }
    }
    number = -1;
    while (at < bytes.size() && std::isdigit(bytes[at]) != 0 && number < 65536) {
      number = (number < 0 ? 0 : number) * 10 + (bytes[at] - '0');
      ++at;
    }
  }
  return number;
}

// MAXVAL of a PAM header; -1 if there is none.
int pam_maximum(const Bytes& bytes) {
  const std::string header(
      bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(1024, bytes.size())));
  const std::size_t at = header.find("MAXVAL ");
  return at == std::string::npos ? -1 : std::atoi(header.c_str() + at + 7);
}

// What OpenCV hides: levels that it stretches, transparency that it drops, greys that it takes for black.
void check_stored_form(const std::string& path, const Bytes& bytes) {
  constexpr std::size_t kPngDepth = 24;
  constexpr std::size_t kPngColourType = 25;
  if (starts_with(bytes, "\x89PNG") && bytes.size() > kPngColourType) {
    if (png_has_chunk(bytes, "tRNS")) refuse(path, "a PNG with transparency (tRNS)", kRule);
    if (bytes[kPngColourType] == 0 && bytes[kPngDepth] < 8) {
      refuse(path, fmt::format("{}-bit grey", bytes[kPngDepth]), kRule);
    }
  }
  constexpr std::size_t kRasDepth = 15;
  constexpr std::size_t kRasMapLength = 28;
  if (starts_with(bytes, "\x59\xA6\x6A\x95") && bytes.size() > kRasMapLength + 4 && bytes[kRasDepth] == 8 &&
      std::all_of(&bytes[kRasMapLength], &bytes[kRasMapLength + 4],
                  [](std::uint8_t byte) { return byte == 0; })) {
    refuse(path, "a Sun raster without colour map", "OpenCV 4.6 reads it as black");
  }
  const bool is_pnm = bytes.size() > 2 && bytes[0] == 'P' && std::isspace(bytes[2]) != 0;
  if (is_pnm && (bytes[1] == '1' || bytes[1] == '4')) refuse(path, "1-bit black and white", kRule);
  if (is_pnm && bytes[1] >= '2' && bytes[1] <= '7') {
    const int maximum = bytes[1] == '7' ? pam_maximum(bytes) : pnm_maximum(bytes);
    if (maximum >= 0 && maximum != 255) {
      refuse(path, fmt::format("a maximum level of {}", maximum), "a PGM, PPM or PAM must state 255");
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
  cv::Mat picture;
  bool known_format = true;
  std::string complaint;
  {
    CapturedStderr captured;
    try {
      picture = cv::imdecode(bytes, cv::IMREAD_UNCHANGED);
      if (picture.empty()) known_format = cv::haveImageReader(path);
    } catch (const cv::Exception&) {
      picture.release();
    }
    complaint = captured.text();
  }
  if (!known_format) refuse(path, "not a picture in a format that OpenCV reads", kRule);
  const bool is_jpeg = starts_with(bytes, "\xFF\xD8");
  if (picture.empty() || (is_jpeg && !jpeg_is_complete(bytes))) {
    refuse(path, "truncated, damaged or too large to decode", "a picture must be complete");
  }
  // A warning of libjpeg only: it puts grey where scan data are damaged and carries on.
  if (is_jpeg && complaint.find("Corrupt JPEG data") != std::string::npos) {
    refuse(path, "a damaged JPEG", "a picture must be complete");
  }
  if (picture.depth() != CV_8U || (picture.channels() != 1 && picture.channels() != 3)) {
    refuse(path, description(picture), kRule);
  }
  check_stored_form(path, bytes);
  return picture;
}

}  // namespace stereotlm::media
