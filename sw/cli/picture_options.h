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

// Parses and checks the options of `run` that select its pictures.
class PictureOptions {
 public:
  // Adds the options to the command, before parsing.
  void add_to(CLI::App& command);

  // To be called in the command's callback: reports missing options. `may_be_missing`: the run needs no
  // pictures.
  void check_given(process::Problems& problems, bool may_be_missing) const;
  // To be called after check_given(): reports all other problems.
  void check_usage(process::Problems& problems);

  bool is_given() const { return !sources_given().empty() || video_layout_.is_given(); }

  // Set by check_usage(). If there were no problems, exactly one member is set, or none if pictures may be
  // missing.
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
