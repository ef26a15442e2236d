#pragma once

#include <memory>
#include <string>
#include <vector>

#include "platform/config/board_config.h"
#include "sw/process/problems.h"
#include "sw/runs/run_json.h"
#include "sw/runs/sources/pair_source.h"
#include "sw/runs/sources/picture_source.h"

namespace stereotlm::runs {

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
OpenedSource open_source(const PictureSource& options, const platform::BoardConfig* board,
                         RecordedOptions& described, process::Problems& problems);

}  // namespace stereotlm::runs
