#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "platform/config/board_config.h"
#include "platform/config/tables.h"
#include "sw/files/output_folder.h"
#include "sw/process/client.h"
#include "sw/process/problems.h"
#include "sw/runs/run_json.h"
#include "sw/runs/sources/open_source.h"

namespace stereotlm::calib {
struct Calibration;
}

namespace stereotlm::runs {

// Paths of the files of a calibration F.yaml. All lie beside it.
struct RigFiles {
  std::filesystem::path calibration;
  std::filesystem::path left_lut;   // F_left.lut
  std::filesystem::path right_lut;  // F_right.lut
  std::filesystem::path drawings;   // F_drawings/
  std::filesystem::path pictures;   // F_pictures/, only for a synthetic rig
};

// Throws std::runtime_error if the name does not end in .yaml.
RigFiles rig_files(const std::string& calibration);

// The files of `calibrate` in the folder of the calibration F.yaml: its mark F.yaml, the tables, the
// drawings, and, if `makes_pictures`, the pictures. Otherwise an existing F_pictures/ stays. Other files in
// the folder stay. New files are first written to the folder F.partial beside F.yaml.
files::OutputContent calibration_content(const RigFiles& files, bool makes_pictures,
                                         const std::vector<files::NamedFile>& inputs = {});

// A calibration that a command has loaded: the file of --calibration and the tables beside it.
struct CalibrationInput {
  std::shared_ptr<const calib::Calibration> calibration;  // never null
  platform::Tables tables;
  InputCalibration described;      // for run.json
  std::vector<NamedFile> files;    // the files that were read
  process::FileContents contents;  // of these files, as process::sent_files() names them
};

// Loads a calibration and checks that it fits the board. Reports all problems and returns nullopt if there
// are any: a damaged file, pictures of another size than the board's, tables that were not written with the
// calibration, a side without table on the board, tables that cannot be joined for a board with joint tables.
// `board`: null if unknown; the fit is then not checked. `named`: the option in messages. `sent`: files that
// are not read.
std::optional<CalibrationInput> load_calibration(const std::string& path, const platform::BoardConfig* board,
                                                 process::Problems& problems,
                                                 const std::string& named = "--calibration",
                                                 const process::FileContents& sent = {});

// The SHA-256 over both tables. It identifies a calibration.
std::string sha256_of(const platform::Tables& tables);

// The tables of the calibration, or identity tables with this offset without one.
platform::Tables tables_of(const platform::BoardConfig& board,
                           const std::optional<CalibrationInput>& calibration, int disparity_offset = 0);

// The columns by which the tables move the left picture, if they do nothing else: its ground truth moves with
// it. 0 if the tables rectify; truth is then that of the rectified picture. Both arguments as for
// tables_of().
int truth_offset(const platform::BoardConfig& board, const std::optional<CalibrationInput>& calibration,
                 int disparity_offset);

}  // namespace stereotlm::runs
