#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sw/cli/problems.h"
#include "sw/cli/typed_option.h"

namespace CLI {
class App;
}

namespace stereotlm::cli {

enum class VideoLayout : std::uint8_t { kTwo, kSideBySide, kTopBottom };

// By its name on the command line; nothing for an unknown one.
std::optional<VideoLayout> video_layout_of(const std::string& name);

// The options of `run` that say which pictures it works on.
class PictureOptions {
 public:
  // Adds them to the command, before it is parsed.
  void add_to(CLI::App& command);

  // While the command's callback runs: reports what is missing, and everything else that is wrong.
  void check_given(Problems& problems, bool may_be_missing) const;
  void check_usage(Problems& problems);

  // As check_usage() leaves them: one of the four is there, if nothing was wrong and it may not be missing.
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
  std::optional<std::string> sequence;
  std::optional<Video> video;
  std::optional<std::uint64_t> synthetic;  // the seed

 private:
  std::vector<std::string> sources_given() const;
  void check_video(Problems& problems);
  void check_synthetic(Problems& problems);

  Typed left_;
  Typed right_;
  Typed sequence_;
  TypedList video_;
  Typed video_layout_;
  Typed synthetic_;
};

}  // namespace stereotlm::cli
