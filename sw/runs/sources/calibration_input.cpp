#include "sw/runs/sources/calibration_input.h"

#include <fmt/format.h>

#include <stdexcept>

#include "calib/calibration.h"
#include "calib/tables.h"
#include "sw/files/text_forms.h"
#include "sw/files/whole_file.h"
#include "sw/process/command.h"
#include "sw/runs/sources/calibration_library.h"

namespace stereotlm::runs {
namespace {

namespace fs = std::filesystem;

InputFile described(const fs::path& path, const std::string& content) {
  return {fs::absolute(path).string(), files::sha256_hex(content.data(), content.size())};
}

kernels::RectificationTable load_table(const fs::path& path, const std::string& content,
                                       const calib::Rig& rig, const std::string& sha256, InputFile& file) {
  file = described(path, content);
  if (file.sha256 != sha256) {
    throw std::runtime_error(
        fmt::format("'{}': SHA-256 {}: must be the table that the calibration was written with, {}",
                    path.string(), file.sha256, sha256));
  }
  try {
    return calib::parse_lut(content, rig.width, rig.height);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(fmt::format("'{}': {}", path.string(), error.what()));
  }
}

// The command that takes the file, if it is a calibration of another kind.
std::string import_hint(const std::string& path) {
  try {
    const std::string text = files::read_whole_file(path, calib::kMostCalibrationBytes);
    const bool is_own = text.find("left_lut_sha256:") != std::string::npos;
    const auto format = calibration_functions().foreign_format({path, text});
    if (format && !is_own)
      return fmt::format(
          "; this file of {} becomes one by stereotlm calibrate --import '{}' --near-mm Z --far-mm Z --out "
          "rig.yaml, with all files of the calibration",
          *format, path);
  } catch (const std::runtime_error&) {
  }
  return "";
}

bool is_calibration(const fs::path& file) {
  try {
    calib::parse_calibration(files::read_whole_file(file, calib::kMostCalibrationBytes));
    return true;
  } catch (const std::exception& /*error*/) {
    return false;
  }
}

}  // namespace

const CalibrationFunctions& calibration_functions() {
  static const auto& functions = *static_cast<const CalibrationFunctions*>(process::plugin_symbol(
      "libstereotlm_calibration.so", "stereotlm_calibration_functions", "calibrates cameras"));
  return functions;
}

RigFiles rig_files(const std::string& calibration) {
  const fs::path path = calibration;
  if (path.extension() != ".yaml") {
    throw std::runtime_error(fmt::format("'{}': the file of a calibration must end in .yaml", calibration));
  }
  const auto beside = [&path](const char* ending) {
    return path.parent_path() / (path.stem().string() + ending);
  };
  return {path, beside("_left.lut"), beside("_right.lut"), beside("_drawings"), beside("_pictures")};
}

files::OutputContent calibration_content(const RigFiles& files, bool makes_pictures,
                                         const std::vector<files::NamedFile>& inputs) {
  const std::string stem = files.calibration.stem();
  files::OutputContent content;
  content.called = "folder";
  content.mark = files.calibration.filename();
  content.kind = {"calibration", is_calibration};
  content.rule =
      "only files that calibrate has made, with their calibration, are replaced: must be moved away";
  content.prefix = stem;
  content.names = {"@(.yaml|_left.lut|_right.lut)", "_drawings/",
                   "_drawings/@(corners|rectified)_+([0-9]).png",
                   "_drawings/@(displacement|source_lines).png"};  // the latter by earlier versions
  if (makes_pictures) {
    content.names.insert(content.names.end(), {"_pictures/", "_pictures/@(left|right)_+([0-9]).png",
                                               "_pictures/scene_@(left|right|truth).png"});
  }
  content.others_stay = true;
  content.inputs = inputs;
  return content;
}

std::optional<CalibrationInput> load_calibration(const std::string& path, const platform::BoardConfig* board,
                                                 process::Problems& problems, const std::string& named,
                                                 const process::FileContents& sent) {
  bool is_right = true;
  const auto attempt = [&](const auto& step) { is_right &= problems.attempt(named + ' ', step); };
  const auto at_path = [&path](const std::string& problem) {
    return std::runtime_error(fmt::format("'{}': {}", path, problem));
  };
  CalibrationInput input;
  input.contents = sent;
  const auto content_of = [&](const char* name, const fs::path& file, std::size_t most_bytes) {
    if (input.contents.count(name) == 0) input.contents[name] = files::read_whole_file(file, most_bytes);
    return input.contents[name];
  };
  attempt([&] {
    const RigFiles files = [&path] {
      try {
        return rig_files(path);
      } catch (const std::runtime_error& error) {
        throw std::runtime_error(error.what() + import_hint(path));
      }
    }();
    for (const fs::path& file : {files.calibration, files.left_lut, files.right_lut}) {
      input.files.push_back({named, file.string()});
    }
    const std::string content =
        content_of("calibration.yaml", files.calibration, calib::kMostCalibrationBytes);
    input.described.file = described(files.calibration, content);
    try {
      input.calibration = std::make_shared<const calib::Calibration>(calib::parse_calibration(content));
      const calib::Rig& rig = input.calibration->rig;
      auto problem =
          board != nullptr ? platform::calibration_size_problem(*board, rig.width, rig.height) : std::nullopt;
      if (!problem && board != nullptr) problem = platform::calibration_buffer_problem(*board);
      if (problem) throw std::runtime_error(*problem);
    } catch (const std::runtime_error& error) {
      throw at_path(error.what() + (input.calibration ? "" : import_hint(path)));
    }
    const calib::Calibration& calibration = *input.calibration;
    const std::size_t bytes = calib::lut_byte_count(calibration.rig.width, calibration.rig.height);
    attempt([&] {
      input.tables.left =
          load_table(files.left_lut, content_of("calibration_left.lut", files.left_lut, bytes),
                     calibration.rig, calibration.left_lut_sha256, input.described.left_lut);
    });
    attempt([&] {
      input.tables.right =
          load_table(files.right_lut, content_of("calibration_right.lut", files.right_lut, bytes),
                     calibration.rig, calibration.right_lut_sha256, input.described.right_lut);
    });
  });
  if (!is_right) return std::nullopt;
  attempt([&] {
    const calib::Calibration& calibration = *input.calibration;
    if (!calib::are_tables_of({*input.tables.left, *input.tables.right}, calibration.rig,
                              calibration.rectification, calibration.disparity_offset)) {
      throw at_path("matrices and disparity_offset: must be those that its tables were made with");
    }
    if (board == nullptr || !board->fpga.joint_tables) return;
    if (const auto problem = platform::joint_tables_problem(input.tables)) throw at_path(*problem);
  });
  if (!is_right) return std::nullopt;
  return input;
}

std::string sha256_of(const platform::Tables& tables) {
  std::string bytes;
  for (const auto& table : {tables.left, tables.right}) {
    if (table) bytes.append(reinterpret_cast<const char*>(table->entries.data()), table->entries.size() * 4);
    bytes += '|';
  }
  return files::sha256_hex(bytes.data(), bytes.size());
}

platform::Tables tables_of(const platform::BoardConfig& board,
                           const std::optional<CalibrationInput>& calibration, int disparity_offset) {
  return calibration ? calibration->tables : platform::identity_tables(board, disparity_offset);
}

int truth_offset(const platform::BoardConfig& board, const std::optional<CalibrationInput>& calibration,
                 int disparity_offset) {
  if (!calibration) return disparity_offset;
  const int offset = calibration->calibration->disparity_offset;
  const platform::Tables moved = platform::identity_tables(board, offset);
  const bool only_moves = calibration->tables.left->entries == moved.left->entries &&
                          calibration->tables.right->entries == moved.right->entries;
  return only_moves ? offset : 0;
}

}  // namespace stereotlm::runs
