#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sw/cli/typed_option.h"
#include "sw/process/problems.h"
#include "sw/runs/sources/picture_source.h"

namespace CLI {
class App;
}

namespace stereotlm::cli {

// The options of `run` that say which pictures it works on.
class PictureOptions {
 public:
  // Adds them to the command, before it is parsed.
  void add_to(CLI::App& command);

  // While the command's callback runs: reports what is missing, and everything else that is wrong.
  void check_given(process::Problems& problems, bool may_be_missing) const;
  void check_usage(process::Problems& problems);

  // Set by check_usage(): one member is set, if nothing was wrong and the source may not be missing.
  runs::PictureSource source;

 private:
  std::vector<std::string> sources_given() const;
  void check_video(process::Problems& problems);
  void check_synthetic(process::Problems& problems);

  Typed left_;
  Typed right_;
  Typed sequence_;
  TypedList video_;
  Typed video_layout_;
  Typed synthetic_;
};

}  // namespace stereotlm::cli
