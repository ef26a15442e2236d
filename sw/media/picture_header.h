#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace stereotlm::media {

struct PictureSize {
  std::uint64_t width = 0;  // pixels
  std::uint64_t height = 0;
};

// What a file is: a format by its first bytes, and the pixels that decoding it takes, by its header.
struct PictureHeader {
  bool is_jpeg = false;
  std::optional<PictureSize> size;  // nothing: the header is not whole
};

// The formats that pictures may have. Nothing for any other.
inline constexpr const char* kPictureFormats =
    "PNG, JPEG, BMP, PGM, PPM, PAM, TIFF, WebP, JPEG 2000 or Sun raster";
std::optional<PictureHeader> read_header(const std::vector<std::uint8_t>& bytes);

// Of a PNM, also a PFM: the number at `index`, from 0, in its header, where comments may stand between
// numbers; nothing if it is not there.
std::optional<std::uint64_t> pnm_number(const std::vector<std::uint8_t>& bytes, int index);
// Of a PAM: the number behind the name of a field.
std::optional<std::uint64_t> pam_number(const std::vector<std::uint8_t>& bytes, const char* field);

}  // namespace stereotlm::media
