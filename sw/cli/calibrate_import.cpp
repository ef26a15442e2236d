#include "sw/cli/calibrate_import.h"

#include <fmt/format.h>

#include <filesystem>
#include <stdexcept>
#include <utility>

#include "calib/calibration.h"
#include "calib/depth.h"
#include "calib/tables.h"
#include "sw/cli/calibration_text.h"
#include "sw/cli/command.h"
#include "sw/files/output_file.h"
#include "sw/files/output_folder.h"
#include "sw/files/text_forms.h"
#include "sw/files/whole_file.h"
#include "sw/runs/sources/calibration_input.h"
#include "sw/runs/sources/calibration_library.h"

namespace stereotlm::cli {
namespace {

namespace fs = std::filesystem;

std::string summary(const calib::ImportedRig& imported, const calib::Calibration& made,
                    const calib::TablePair& tables) {
  return calibration_row(
             "imported",
             imported.format + (imported.rectification ? ", pictures that are rectified already" : "")) +
         calibration_text(made) + calibration_row("left table", entries_text(tables.left)) +
         calibration_row("right table", entries_text(tables.right));
}

// The offset that is given, or that the depths need.
int offset_of(const Import& import, const calib::Calibration& made) {
  if (import.offset) return *import.offset;
  const calib::DepthGeometry geometry = {made.rectification.q, 0};
  const calib::DisparityRange range = {calib::disparity_at(geometry, *import.far_mm),
                                       calib::disparity_at(geometry, *import.near_mm)};
  if (range.needed() > import.disparities) {
    throw std::runtime_error(fmt::format(
        "--near-mm {:g} to --far-mm {:g} are {} disparities, {:.1f} .. {:.1f}, and the board has {}: depths "
        "that "
        "are less far apart, or more --disparities (254 at most)",
        *import.near_mm, *import.far_mm, range.needed(), range.min, range.max, import.disparities));
  }
  return calib::disparity_offset_for(range, import.disparities);
}

std::vector<files::NamedFile> inputs_of(const Import& import) {
  std::vector<files::NamedFile> inputs;
  for (const std::string& file : import.files) inputs.push_back({"--import", file});
  return inputs;
}

int export_rig(const Import& import, const calib::Calibration& made) {
  const auto written = runs::calibration_functions().export_rig(made.rig, made.rectification, import.format);
  const fs::path out = import.out;
  const files::FileKind kind = {"file of --export", [](const fs::path& earlier) {
                                  return files::read_whole_file(earlier).find(calib::kExportMark) < 20;
                                }};
  std::string names;
  for (const calib::ForeignFile& file : written) {
    const std::string path = out.parent_path() / (out.stem().string() + file.path);
    for (const files::NamedFile& input : inputs_of(import)) files::check_is_another(path, {input});
    if (!write_out(path, kind, file.text)) return interrupted("nothing more was written");
    names += (names.empty() ? "" : ", ") + path;
  }
  process::print(calibration_row("written", names));
  return kDone;
}

}  // namespace

int import_calibration(const Import& import) {
  process::catch_interrupts();
  const runs::CalibrationFunctions& functions = runs::calibration_functions();
  std::vector<calib::ForeignFile> files;
  calib::ImportedRig imported;
  calib::Calibration made;
  calib::TablePair tables;
  process::attempt_or_refuse("--import ", [&] {
    for (const std::string& file : import.files)
      files.push_back({file, files::read_whole_file(file, calib::kMostCalibrationBytes)});
    imported = functions.import_rig(files, import.options);
    made.imported = import.files;
    made.rig = imported.rig;
    made.rectification = imported.rectification ? *imported.rectification : functions.rectify(imported.rig);
    made.disparities = import.disparities;
  });
  if (!import.format.empty()) return export_rig(import, made);
  process::attempt_or_refuse("", [&] {
    made.disparity_offset = offset_of(import, made);
    tables = calib::tables(made.rig, made.rectification, made.disparity_offset);
    calib::check_sources(tables, made.disparity_offset);
  });
  const std::string left = calib::lut_bytes(tables.left);
  const std::string right = calib::lut_bytes(tables.right);
  made.left_lut_sha256 = files::sha256_hex(left.data(), left.size());
  made.right_lut_sha256 = files::sha256_hex(right.data(), right.size());
  const runs::RigFiles paths = runs::rig_files(import.out);
  process::attempt_or_refuse("--out ", [&] {
    const fs::path folder = paths.calibration.parent_path();
    files::OutputFolder output(folder.empty() ? "." : folder,
                               runs::calibration_content(paths, false, inputs_of(import)));
    const auto add = [&](const fs::path& file, const std::string& bytes) {
      output.add(file.lexically_relative(folder), bytes);
    };
    add(paths.left_lut, left);
    add(paths.right_lut, right);
    add(paths.calibration, functions.calibration_yaml(made));
    if (!process::interrupted()) output.commit();
  });
  if (process::interrupted()) return interrupted("nothing was written");
  process::print(summary(imported, made, tables) +
                 calibration_row("written", fmt::format("{}, {}, {}", paths.calibration.string(),
                                                        paths.left_lut.string(), paths.right_lut.string())));
  return kDone;
}

}  // namespace stereotlm::cli
