#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <future>
#include <memory>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "calib/synthetic_rig.h"
#include "calib/tables.h"
#include "sw/cli/add_command.h"
#include "sw/cli/calibrate_options.h"
#include "sw/cli/calibration_output.h"
#include "sw/cli/calibration_summary.h"
#include "sw/cli/commands.h"
#include "sw/cli/exit_status.h"
#include "sw/cli/grid_pictures.h"
#include "sw/files/output_file.h"
#include "sw/files/sha256.h"
#include "sw/files/whole_file.h"
#include "sw/media/encode.h"
#include "sw/process/interrupt.h"
#include "sw/process/streams.h"
#include "sw/runs/sources/calibration_library.h"

namespace stereotlm::cli {
namespace {

namespace fs = std::filesystem;

constexpr int kSyntheticWidth = 640;  // image width of fpl2003, pixels
constexpr int kSyntheticHeight = 480;
constexpr int kSyntheticPairs = 9;

[[noreturn]] void refuse_step(const std::string& option, const std::exception& error) {
  process::refuse(option + (option.empty() ? "" : " ") + error.what());
}

int leave_unwritten() {
  process::say("note", "interrupted: nothing was written");
  return kInterrupted;
}

int print_grid(const CalibrateOptions& options) {
  process::catch_interrupts();
  try {
    const bool is_pdf = fs::path(options.out).extension() == ".pdf";
    const runs::CalibrationFunctions& functions = runs::calibration_functions();
    const std::string sheet =
        is_pdf ? functions.grid_sheet_pdf(options.grid) : functions.grid_sheet_svg(options.grid);
    files::OutputFile file(options.out, {"sheet of the same grid", [&sheet](const fs::path& earlier) {
                                           return files::read_whole_file(earlier) == sheet;
                                         }});
    file.write(sheet);
    file.complete();
    if (process::interrupted()) return leave_unwritten();
    file.commit();
  } catch (const std::invalid_argument& error) {
    refuse_step("--print-grid:", error);
  } catch (const std::exception& error) {
    refuse_step("--out", error);
  }
  process::print(fmt::format("{}: {}x{} squares of {} mm, {}x{} inner corners; print it at 100 %\n",
                             options.out, options.grid.columns + 1, options.grid.rows + 1,
                             options.grid.square_mm, options.grid.columns, options.grid.rows));
  return kDone;
}

// The pictures of a synthetic rig.
std::vector<calib::PicturePair> synthetic_pictures(const calib::SyntheticRig& rig,
                                                   const calib::GridShape& grid, const fs::path& folder) {
  std::vector<calib::PicturePair> pairs;
  for (int number = 0; number < kSyntheticPairs; ++number) {
    auto pictures = rig.grid_view(grid, number);
    const auto name = [&](const char* side) {
      return (folder / fmt::format("{}_{:02}.png", side, number)).string();
    };
    pairs.push_back({name("left"), name("right"), std::move(pictures.left), std::move(pictures.right)});
  }
  return pairs;
}

class Calibrator {
 public:
  explicit Calibrator(const CalibrateOptions& options)
      : options_(options), request_{options.grid, {}, 0, {}} {
    request_.disparities = options.disparities;
    request_.disparity_offset = options.disparity_offset;
  }

  int run() {
    process::catch_interrupts();
    process::Problems problems;
    load_pictures(problems);
    const bool is_synthetic = options_.synthetic.has_value();
    std::vector<files::NamedFile> inputs;
    for (const calib::PicturePair& pair : request_.pictures) {
      if (is_synthetic) break;  // the pictures are outputs
      inputs.push_back({"--left", pair.left_name});
      inputs.push_back({"--right", pair.right_name});
    }
    try {
      files_ = runs::rig_files(options_.out);
      fs::path folder = files_.calibration.parent_path();
      if (folder.empty()) folder = ".";
      std::error_code error;
      const fs::file_status status = fs::status(folder, error);
      if (!fs::is_directory(status)) {
        throw std::runtime_error(fmt::format("'{}': {}", folder.string(),
                                             fs::status_known(status) ? "no such folder" : error.message()));
      }
      output_ =
          std::make_unique<files::OutputFolder>(folder, calibration_content(files_, is_synthetic, inputs));
    } catch (const std::exception& error) {
      problems.add(fmt::format("--out {}", error.what()));
    }
    if (process::interrupted()) return leave_unwritten();
    problems.check();
    calibrate();
    for (const std::string& picture : result_.skipped)
      process::say("note", picture + ": the pair is skipped");
    try {
      write();
      if (process::interrupted()) return leave_unwritten();
      output_->commit();
    } catch (const std::runtime_error& error) {
      refuse_step("--out", error);
    }
    process::print(calibration_summary(result_, request_.pictures.size()) + written_text());
    return kDone;
  }

 private:
  // Calibrates on a separate thread, because OpenCV cannot be stopped: an interrupt ends the process.
  void calibrate() {
    constexpr std::chrono::milliseconds kPollInterval{50};
    auto result =
        std::async(std::launch::async, runs::calibration_functions().calibrate, std::cref(request_));
    while (result.wait_for(kPollInterval) != std::future_status::ready) {
      if (!process::interrupted()) continue;
      output_.reset();
      std::_Exit(leave_unwritten());
    }
    try {
      result_ = result.get();
    } catch (const std::exception& error) {
      refuse_step("", error);
    }
  }

  void load_pictures(process::Problems& problems) {
    if (!options_.synthetic) {
      request_.pictures = load_grid_pictures(options_.left, options_.right, problems);
      return;
    }
    try {
      rig_ = std::make_unique<calib::SyntheticRig>(*options_.synthetic, kSyntheticWidth, kSyntheticHeight);
      request_.pictures = synthetic_pictures(*rig_, options_.grid, runs::rig_files(options_.out).pictures);
    } catch (const std::exception& error) {
      problems.add(fmt::format("--synthetic: {}", error.what()));
    }
  }

  // Adds a file of the calibration, which has this path.
  template <typename Bytes>
  void add(const fs::path& file, const Bytes& bytes) {
    output_->add(file.lexically_relative(files_.calibration.parent_path()), bytes);
  }

  void write() {
    const std::string left = calib::lut_bytes(result_.tables.left);
    const std::string right = calib::lut_bytes(result_.tables.right);
    result_.calibration.left_lut_sha256 = files::sha256_hex(left.data(), left.size());
    result_.calibration.right_lut_sha256 = files::sha256_hex(right.data(), right.size());
    add(files_.left_lut, left);
    add(files_.right_lut, right);
    add(files_.calibration, runs::calibration_functions().calibration_yaml(result_.calibration));
    draw(files_.drawings);
    if (rig_) write_synthetic(files_.pictures);
  }

  void draw(const fs::path& folder) {
    const runs::CalibrationFunctions& functions = runs::calibration_functions();
    for (const calib::CalibratedPair& pair : result_.pairs) {
      if (process::interrupted()) return;
      const calib::PicturePair& pictures = request_.pictures[pair.picture];
      const auto named = [](const std::string& path, const kernels::GrayImage& image) {
        return calib::CaptionedImage{fs::path(path).filename(), image};
      };
      std::vector<bool> left_out = pair.used;
      left_out.flip();
      add(folder / fmt::format("corners_{:02}.png", pair.picture),
          functions.encode_corners_png(
              request_.grid, named(pictures.left_name, pictures.left), {pair.corners.left, left_out},
              named(pictures.right_name, pictures.right), {pair.corners.right, left_out}));
      add(folder / fmt::format("rectified_{:02}.png", pair.picture),
          functions.encode_rectified_pair_png(
              named(pictures.left_name, kernels::rectify(pictures.left, result_.tables.left)),
              named(pictures.right_name, kernels::rectify(pictures.right, result_.tables.right))));
    }
    add(folder / "displacement.png",
        functions.encode_displacement_png(result_.tables.left, result_.tables.right));
    add(folder / "source_lines.png",
        functions.encode_source_lines_png(result_.tables.left, result_.tables.right));
  }

  // Writes the pictures that the calibration used, and a stereo pair of a scene with the disparities that the
  // board should find.
  void write_synthetic(const fs::path& folder) {
    for (const calib::PicturePair& pictures : request_.pictures) {
      if (process::interrupted()) return;
      add(pictures.left_name, media::encode_png_gray(pictures.left));
      add(pictures.right_name, media::encode_png_gray(pictures.right));
    }
    const auto scene = rig_->scene();
    add(folder / "scene_left.png", media::encode_png_gray(scene.left));
    add(folder / "scene_right.png", media::encode_png_gray(scene.right));
    const calib::Calibration& made = result_.calibration;
    const std::vector<float> truth = rig_->disparity(made.rig, made.rectification, made.disparity_offset);
    kernels::GrayImage grey(made.rig.width, made.rig.height);
    for (std::size_t i = 0; i < truth.size(); ++i) {
      const double level = std::floor(double{truth[i]} * truth_scale() + 0.5);
      if (level > 0 && level <= 255) grey.pixels[i] = static_cast<std::uint8_t>(level);
    }
    add(folder / "scene_truth.png", media::encode_png_gray(grey));
  }

  // Grey levels per disparity in the truth of the scene.
  int truth_scale() const { return 255 / options_.disparities; }

  std::string written_text() const {
    std::string text =
        fmt::format("{:<16} {}, {}, {}, {}/\n", "written", files_.calibration.string(),
                    files_.left_lut.string(), files_.right_lut.string(), files_.drawings.string());
    if (!rig_) return text;
    const auto& known = rig_->rig();
    text += fmt::format("{:<16} left focal length {:.1f} px, baseline {:.2f} mm\n", "known to be",
                        known.left.matrix(0, 0), known.translation.norm());
    const std::string folder = files_.pictures.string();
    text += fmt::format(
        "{:<16} stereotlm run fpl2003 --source preloaded --set matcher.disparities={} \\\n"
        "{:<16}   --left {}/scene_left.png --right {}/scene_right.png --calibration {} \\\n"
        "{:<16}   --truth {}/scene_truth.png --truth-scale {}\n",
        "to go on", options_.disparities, "", folder, folder, files_.calibration.string(), "", folder,
        truth_scale());
    return text;
  }

  const CalibrateOptions& options_;
  calib::CalibrationRequest request_;
  runs::RigFiles files_;
  std::unique_ptr<files::OutputFolder> output_;
  std::unique_ptr<calib::SyntheticRig> rig_;
  calib::CalibrationResult result_;
};

int calibrate(const CalibrateOptions& options) {
  return options.print_grid ? print_grid(options) : Calibrator(options).run();
}

}  // namespace

void add_calibrate(CLI::App& program, Action& action) {
  add_command(program, action, "calibrate", "Make a board's tables from pictures of a grid, or draw the grid",
              calibrate);
}

}  // namespace stereotlm::cli
