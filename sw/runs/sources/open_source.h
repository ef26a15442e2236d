#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "platform/config/board_config.h"
#include "sw/files/output_file.h"
#include "sw/media/truth.h"
#include "sw/process/problems.h"
#include "sw/runs/run_json.h"
#include "sw/runs/sources/pair_source.h"
#include "sw/runs/sources/picture_source.h"

namespace stereotlm::runs {

using files::NamedFile;

// The result of open_source().
struct OpenedSource {
  std::unique_ptr<PairSource> pairs;  // null if it cannot be used
  std::vector<NamedFile> files;       // files that were named or found, usable or not
  std::vector<std::string> notes;     // for standard error
};

// Opens the source of pictures and checks all its pictures. Reports problems. Fills the fields of `described`
// that concern the pictures. `board`: null if unknown; the sizes of the pictures are then not checked.
OpenedSource open_source(const PictureSource& options, const platform::BoardConfig* board,
                         RecordedOptions& described, process::Problems& problems);

// Loads the ground truth and checks its size. Reports problems and returns nullopt if there are any. `board`:
// null if unknown; the size is then not checked.
std::optional<media::Truth> open_truth(const NamedFile& file, double scale,
                                       const platform::BoardConfig* board, process::Problems& problems);

}  // namespace stereotlm::runs
