// The rules for every format of pictures.
#include <algorithm>

#include "sw/media/decode.h"

namespace stereotlm::media {

void drop_alpha(Picture& picture) {
  const auto samples = static_cast<std::size_t>(picture.channels);
  std::size_t seen_through = 0;  // pixels
  auto to = picture.samples.begin();
  for (auto from = picture.samples.begin(); from != picture.samples.end(); ++from) {
    to = std::copy_n(from, samples - 1, to);
    from += picture.channels - 1;
    seen_through += *from != 255 ? 1U : 0U;
  }
  picture.samples.erase(to, picture.samples.end());
  --picture.channels;
  if (seen_through > 0) {
    refuse_picture(fmt::format("{} pixels are transparent", seen_through),
                   std::string(kPixelRule) + " without transparency: put it on a background first");
  }
}

std::optional<unsigned> tiff_field(std::string_view tiff, unsigned tag, std::size_t* place) {
  constexpr unsigned kShort = 3;
  const bool is_little = tiff.substr(0, 2) == "II";
  const auto number = [&](std::size_t at, std::size_t bytes) -> std::size_t {
    std::size_t value = 0;
    for (std::size_t i = 0; i < bytes && at + bytes <= tiff.size(); ++i)
      value = value << 8U | static_cast<unsigned char>(tiff[is_little ? at + bytes - 1 - i : at + i]);
    return value;
  };
  const std::size_t directory = number(4, 4);
  for (std::size_t entry = 0; entry < number(directory, 2); ++entry) {
    const std::size_t at = directory + 2 + 12 * entry;
    if (number(at, 2) != tag || number(at + 2, 2) != kShort || number(at + 4, 4) != 1) continue;
    if (place != nullptr) *place = at + 8;
    return static_cast<unsigned>(number(at + 8, 2));
  }
  return std::nullopt;
}

void note_orientation(std::string_view exif, Picture& picture) {
  constexpr unsigned kOrientation = 274;
  const auto orientation = tiff_field(exif, kOrientation);
  if (orientation && *orientation > 1)
    picture.notes.push_back(fmt::format("its orientation {} is ignored: read as stored", *orientation));
}

}  // namespace stereotlm::media
