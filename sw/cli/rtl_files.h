#pragma once

#include <string_view>
#include <vector>

namespace stereotlm::cli {

// A file of models/rtl that is compiled in.
struct RtlFile {
  std::string_view name;  // below models/rtl: "lane.v", "board/bench.v"
  std::string_view text;
};

// Those of the core, and those of the folder `board`: what `rtl` puts around the core.
const std::vector<RtlFile>& rtl_files();

}  // namespace stereotlm::cli
