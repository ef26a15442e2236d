#pragma once

#include <string_view>
#include <vector>

namespace stereotlm::platform {

// A board file that is compiled in.
struct Preset {
  std::string_view name;
  std::string_view text;
};

// All presets, `fpl2003` first.
const std::vector<Preset>& presets();

}  // namespace stereotlm::platform
