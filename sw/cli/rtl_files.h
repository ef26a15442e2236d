#pragma once

#include <string_view>
#include <utility>
#include <vector>

namespace stereotlm::cli {

// The files that `rtl` writes for any board: name in DIR, and text.
const std::vector<std::pair<std::string_view, std::string_view>>& rtl_files();

}  // namespace stereotlm::cli
