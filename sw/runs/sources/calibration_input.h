#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "platform/config/board_config.h"
#include "platform/config/tables.h"
#include "sw/process/problems.h"
#include "sw/runs/run_json.h"
#include "sw/runs/sources/open_source.h"

namespace stereotlm::calib {
struct Calibration;
}

namespace stereotlm::runs {

// The file of --calibration and the tables beside it.
struct CalibrationInput {
  std::shared_ptr<const calib::Calibration> calibration;  // never null
  platform::Tables tables;
  InputCalibration described;
  std::vector<NamedFile> files;
};

// Loads and checks it for the board. Nothing if it cannot be used, with every reason reported: a file that is
// damaged, of another size than the board's pictures, tables that are not those that it was written with, a
// side without table. `board`: null if it is not known, which is reported elsewhere. `named`: where the path
// was given.
std::optional<CalibrationInput> load_calibration(const std::string& path, const platform::BoardConfig* board,
                                                 process::Problems& problems,
                                                 const std::string& named = "--calibration");

// Of both tables: what tells calibrations apart.
std::string sha256_of(const platform::Tables& tables);

// The tables of the board: those of the calibration, or without one the identity.
platform::Tables tables_of(const platform::BoardConfig& board,
                           const std::optional<CalibrationInput>& calibration);

}  // namespace stereotlm::runs
