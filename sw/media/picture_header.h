#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace stereotlm::media {

struct PictureSize {
  std::uint64_t width = 0;  // pixels
  std::uint64_t height = 0;
};

// The format of a picture file, by its first bytes, and the size that decoding it needs, by its header.
struct PictureHeader {
  bool is_jpeg = false;
  std::optional<PictureSize> size;  // nullopt: the header is incomplete
};

// Parses the header of an accepted format; nullopt for any other.
inline constexpr const char* kPictureFormats =
    "PNG, JPEG, BMP, PGM, PPM, PAM, TIFF, WebP, JPEG 2000 or Sun raster";
std::optional<PictureHeader> read_header(const std::vector<std::uint8_t>& bytes);

// Number `index`, from 0, in the header of a PNM or PFM, whose numbers may have comments between them; nullopt if
// it does not exist.
std::optional<std::uint64_t> pnm_number(const std::vector<std::uint8_t>& bytes, int index);
// The number after a field's name in the header of a PAM.
std::optional<std::uint64_t> pam_number(const std::vector<std::uint8_t>& bytes, const char* field);

}  // namespace stereotlm::media
