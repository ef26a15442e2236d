#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace stereotlm::media {

struct PictureSize {
  std::uint64_t width = 0;  // pixels
  std::uint64_t height = 0;
};

// What the first bytes of a picture file state: its format, and the size of the picture that a decoder
// allocates.
struct PictureHeader {
  bool is_jpeg = false;
  std::optional<PictureSize> size;  // nullopt: the header is incomplete
};

// The formats that are read.
inline constexpr const char* kPictureFormats =
    "PNG, JPEG, BMP, PGM, PPM, PAM, TIFF, WebP, JPEG 2000 or Sun raster";

// Parses the header of a picture file; nullopt if it is in none of these formats.
std::optional<PictureHeader> read_header(const std::vector<std::uint8_t>& bytes);

// The number with this index, from 0, in the header of a PNM or PFM. Skips comments between the numbers.
// nullopt if the header has no such number.
std::optional<std::uint64_t> pnm_number(const std::vector<std::uint8_t>& bytes, int index);
// The number after the name of a field in the header of a PAM; nullopt if the header has no such number.
std::optional<std::uint64_t> pam_number(const std::vector<std::uint8_t>& bytes, const char* field);

}  // namespace stereotlm::media
