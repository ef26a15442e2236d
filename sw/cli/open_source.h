#pragma once

#include <memory>
#include <string>
#include <vector>

#include "platform/board_config.h"
#include "sw/cli/pair_source.h"
#include "sw/cli/picture_options.h"
#include "sw/cli/problems.h"
#include "sw/report/run_json.h"

namespace stereotlm::cli {

// A file that the command line names, or finds by a name there.
struct NamedFile {
  std::string option;
  std::string path;

  std::string text() const { return option + " '" + path + "'"; }
};

struct OpenedSource {
  std::unique_ptr<PairSource> pairs;  // null if it cannot be used
  std::vector<NamedFile> files;       // that were named or found; also if they cannot be used
  std::vector<std::string> notes;     // for standard error
};

// Opens the source of pictures that the options name and checks all that it will show. Reports what is wrong;
// enters into `described` what run.json says about it. `board`: null if it is not known, which leaves sizes
// unchecked and is reported elsewhere.
OpenedSource open_source(const PictureOptions& options, const platform::BoardConfig* board,
                         report::RunOptions& described, Problems& problems);

}  // namespace stereotlm::cli
