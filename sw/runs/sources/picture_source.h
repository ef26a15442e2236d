#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace stereotlm::runs {

// Where a video has the two pictures of a pair.
enum class VideoLayout : std::uint8_t { kTwo, kSideBySide, kTopBottom };

// Names of the layouts on the command line, in the order of VideoLayout.
inline const std::vector<std::string> kVideoLayoutNames = {"two", "side_by_side", "top_bottom"};

// nullopt for an unknown name.
inline std::optional<VideoLayout> video_layout_of(const std::string& name) {
  const auto found = std::find(kVideoLayoutNames.begin(), kVideoLayoutNames.end(), name);
  if (found == kVideoLayoutNames.end()) return std::nullopt;
  return static_cast<VideoLayout>(found - kVideoLayoutNames.begin());
}

// The source of a run's pictures as the user names it. At most one member is set.
struct PictureSource {
  struct Pair {
    std::string left;
    std::string right;
  };
  struct Video {
    std::vector<std::string> files;  // two for kTwo, the left one first, else one
    VideoLayout layout = VideoLayout::kTwo;
    std::string layout_name;  // as on the command line
  };
  std::optional<Pair> pair;
  std::optional<std::string> sequence;  // a folder
  std::optional<Video> video;
  std::optional<std::uint64_t> synthetic;  // the seed of a synthetic scene
};

}  // namespace stereotlm::runs
