#include "sw/runs/sources/picture_source.h"

#include <algorithm>

namespace stereotlm::runs {

const std::vector<std::string>& video_layout_names() {
  static const std::vector<std::string> names = {"two", "side_by_side", "top_bottom"};
  return names;
}

std::optional<VideoLayout> video_layout_of(const std::string& name) {
  const auto& names = video_layout_names();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) return std::nullopt;
  return static_cast<VideoLayout>(found - names.begin());
}

}  // namespace stereotlm::runs
