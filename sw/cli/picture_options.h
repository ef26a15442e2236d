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

// The options of `run` that select its pictures.
class PictureOptions {
 public:
  // Adds the options to the command, before parsing.
  void add_to(CLI::App& command);

  // To be called in the command's callback: report missing options, and all other problems.
  void check_given(process::Problems& problems, bool may_be_missing) const;
  void check_usage(process::Problems& problems);

  // Set by check_usage(). Exactly one member is set if there were no problems and the source is required.
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
