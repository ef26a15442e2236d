#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>
#include <system_error>
#include <tuple>
#include <utility>
#include <vector>

#include "calib/depth.h"
#include "calib/grid_sheet.h"
#include "calib/tables.h"
#include "calib/verdict.h"
#include "models/kernels/limits.h"
#include "sw/cli/calibrate_import.h"
#include "sw/cli/calibration_text.h"
#include "sw/cli/command.h"
#include "sw/cli/run_options.h"
#include "sw/files/output_file.h"
#include "sw/files/output_folder.h"
#include "sw/files/text_forms.h"
#include "sw/files/whole_file.h"
#include "sw/media/encode.h"
#include "sw/media/synthetic_rig.h"
#include "sw/process/streams.h"
#include "sw/runs/progress.h"
#include "sw/runs/sources/calibration_input.h"
#include "sw/runs/sources/calibration_library.h"
#include "sw/runs/sources/grid_pictures.h"

namespace stereotlm::cli {
namespace {

using calib::Calibration;
namespace fs = std::filesystem;

constexpr int kWindow = 7;  // window of fpl2003, pixels

std::string pairs_text(const calib::CalibrationResult& result, std::size_t pictures) {
  const auto& sources = result.calibration.sources;
  const std::size_t corners =
      std::accumulate(sources.begin(), sources.end(), std::size_t{0},
                      [](std::size_t sum, const calib::Source& source) { return sum + source.corners_used; });
  return fmt::format("{} of {} with the grid; of {} corners each, {} fit, {} do not", result.pairs.size(),
                     pictures, result.calibration.grid.corners(), corners, result.left_out.size());
}

std::string table_text(const kernels::RectificationTable& table) {
  std::string text = entries_text(table);
  if (table.height >= kWindow) {
    text += fmt::format("; a window of {} lines touches up to {} of the picture", kWindow,
                        calib::source_lines(table, kWindow));
  }
  return text;
}

std::string left_out_text(const calib::CalibrationResult& result) {
  constexpr std::size_t kMost = 10;
  std::string text;
  for (std::size_t i = 0; i < std::min(kMost, result.left_out.size()); ++i) {
    const calib::LeftOutCorner& corner = result.left_out[i];
    const calib::Source& source = result.calibration.sources[corner.pair];
    const auto columns = static_cast<std::size_t>(result.calibration.grid.columns);
    text += calibration_row(
        i == 0 ? "left out" : "",
        fmt::format("corner ({}, {}) of '{}' and '{}': off by {:.2f} px", corner.corner % columns,
                    corner.corner / columns, source.left, source.right, corner.misfit_px));
  }
  if (result.left_out.size() > kMost)
    text += calibration_row("", fmt::format("and {} more", result.left_out.size() - kMost));
  return text;
}

std::string calibration_summary(const calib::CalibrationResult& result, std::size_t pictures) {
  std::string text = calib::verdict_of(result.calibration) + '\n';
  text += calibration_row("pairs", pairs_text(result, pictures));
  text += left_out_text(result);
  if (result.lens == calib::Lens::kWithoutK3) {
    text +=
        calibration_row("lenses", "k3 is taken as 0: the grid was not seen far enough out to determine it");
  }
  text += calibration_text(result.calibration);
  text += calibration_row("left table", table_text(result.tables.left));
  text += calibration_row("right table", table_text(result.tables.right));
  return text;
}

constexpr int kSyntheticWidth = 640;  // image width of fpl2003, pixels
constexpr int kSyntheticHeight = 480;
constexpr int kSyntheticPairs = 9;
constexpr int kDefaultDisparities = 80;

constexpr const char* kCalibrateExample =
    "stereotlm calibrate --left 'left*.jpg' --right 'right*.jpg' --grid 9x6 --square-mm 25 --out rig.yaml";
constexpr const char* kPrintExample = "stereotlm calibrate --print-grid 9x6 --square-mm 25 --out grid.svg";
constexpr const char* kGridRule = "columns x rows of inner corners, such as 9x6";

// Sets columns and rows; returns false if the text is not CxR.
bool read_grid(const std::string& text, calib::GridShape& grid) {
  const std::size_t cross = text.find('x');
  if (cross == std::string::npos) return false;
  const auto columns = number_of<int>(text.substr(0, cross));
  const auto rows = number_of<int>(text.substr(cross + 1));
  grid.columns = columns.value_or(0);
  grid.rows = rows.value_or(0);
  return columns && rows;
}

// Width and height; nullopt if the text is not WxH.
std::optional<std::pair<int, int>> size_of(const std::string& text) {
  calib::GridShape size;
  if (!read_grid(text, size)) return std::nullopt;
  return std::pair(size.columns, size.rows);
}

Rule is_grid() {
  return valid(kGridRule, [](const std::string& text) {
    calib::GridShape grid;
    return read_grid(text, grid);
  });
}

Rule is_offset() {
  constexpr int kMost = 2048;  // columns
  return valid(fmt::format("auto or an integer, -{}..{}", kMost, kMost), [](const std::string& text) {
    return text == "auto" || std::abs(number_of<int>(text).value_or(kMost + 1)) <= kMost;
  });
}

struct CalibrateOptions : Options {
  using Options::Options;

  void check_together(process::Problems& problems) override {
    if (checked.is_given()) return check_alone(problems);
    if (!out.is_given())
      problems.add("--out: missing: the calibration, F.yaml, or the sheet of --print-grid, F.svg");
    if (import.is_given()) return check_import(problems);
    for (const Option* option : {&size, &unit, &lens, &cameras, &near, &far, &exported}) {
      if (option->is_given()) problems.add(fmt::format("{}: goes with --import", option->name()));
    }
    if (!square.is_given()) problems.add("--square-mm: missing: a side of the grid's squares in millimetres");
    if (print_grid.is_given()) {
      for (const Option* option :
           {&grid, &left, &right, &side_by_side, &video, &video_layout, &synthetic, &disparities, &offset}) {
        if (option->is_given())
          problems.add(fmt::format("{}: does not go with --print-grid", option->name()));
      }
      if (grid_shape().pattern != calib::Pattern::kChessboard)
        problems.add("--print-grid: draws a chessboard only");
      ends_in(".svg")(out, problems);
    } else {
      if (!grid.is_given()) problems.add(fmt::format("--grid: missing: {}", kGridRule));
      const bool has_sides = left.is_given() || right.is_given();
      const bool has_video = video.is_given();
      check_video(video, video_layout, problems);
      if (has_video && (has_sides || side_by_side.is_given() || synthetic.is_given()))
        problems.add("--video: has both pictures of a pair: does not go with other pictures");
      if (synthetic.is_given() && (has_sides || side_by_side.is_given()))
        problems.add(
            "--synthetic: makes its own pictures: does not go with --left, --right and --side-by-side");
      if (side_by_side.is_given() && has_sides)
        problems.add("--side-by-side: has both pictures of a pair: does not go with --left and --right");
      for (const auto& [side, option] : {std::pair("left", &left), std::pair("right", &right)}) {
        if (!synthetic.is_given() && !has_video && !side_by_side.is_given() && !option->is_given())
          problems.add(fmt::format("--{0}: missing: the {0} camera's pictures (or --synthetic SEED)", side));
      }
      ends_in(".yaml")(out, problems);
    }
    if (!problems.empty()) {
      problems.add_note(std::string("a complete command: ") +
                        (print_grid.is_given() ? kPrintExample : kCalibrateExample));
    } else {
      for (const std::string& problem : calib::problems(grid_shape()))
        problems.add(fmt::format("grid: {}", problem));
    }
  }

  // With --check, which goes with no other option.
  void check_alone(process::Problems& problems) {
    for (const Option* option :
         {&grid,         &pattern,   &square,     &left,        &right,  &side_by_side, &video,
          &video_layout, &synthetic, &print_grid, &disparities, &offset, &import,       &size,
          &unit,         &lens,      &cameras,    &near,        &far,    &exported,     &out}) {
      if (option->is_given()) problems.add(fmt::format("{}: does not go with --check", option->name()));
    }
  }

  // With --import, in place of the others.
  void check_import(process::Problems& problems) {
    for (const Option* option : {&grid, &pattern, &square, &left, &right, &side_by_side, &video,
                                 &video_layout, &synthetic, &print_grid}) {
      if (option->is_given()) problems.add(fmt::format("{}: does not go with --import", option->name()));
    }
    ends_in(".yaml")(out, problems);
    const bool has_depths = near.is_given() && far.is_given();
    if (exported.is_given()) {
      for (const Option* option : {&disparities, &offset, &near, &far}) {
        if (option->is_given()) problems.add(fmt::format("{}: does not go with --export", option->name()));
      }
    } else if (offset.is_given() == has_depths || near.is_given() != far.is_given() ||
               offset.text() == "auto") {
      problems.add(
          "--import: needs the depths to see, --near-mm and --far-mm, or instead --disparity-offset N");
    } else if (has_depths && *near.number<double>() >= *far.number<double>()) {
      problems.add(fmt::format("--near-mm = {}: must be less than --far-mm, {}", near.text(), far.text()));
    }
  }

  Import import_request() const {
    Import request;
    request.files = import.texts();
    calib::ImportOptions& options = request.options;
    if (size.is_given()) options.size = size_of(size.text());
    if (unit.is_given()) options.unit_mm = unit.text() == "m" ? 1000 : unit.text() == "cm" ? 10 : 1;
    if (lens.is_given()) options.is_fisheye = lens.text() == "fisheye";
    if (cameras.is_given()) {
      const std::size_t comma = cameras.text().find(',');
      options.cameras = {cameras.text().substr(0, comma), cameras.text().substr(comma + 1)};
    }
    request.disparities = disparities.number<int>().value_or(kDefaultDisparities);
    request.offset = offset.number<int>();
    request.near_mm = near.number<double>();
    request.far_mm = far.number<double>();
    request.out = out.text();
    request.format = exported.text();
    return request;
  }

  // Of --grid, or of --print-grid.
  calib::GridShape grid_shape() const {
    calib::GridShape shape;
    read_grid(print_grid.is_given() ? print_grid.text() : grid.text(), shape);
    shape.square_mm = square.number<double>().value_or(0);
    shape.pattern = calib::pattern_named(pattern.text()).value_or(calib::Pattern::kChessboard);
    return shape;
  }
  // Columns; nullopt: auto.
  std::optional<int> disparity_offset() const {
    if (!offset.is_given() && synthetic.is_given()) return 0;
    return offset.number<int>();
  }

  Option left =
      Option(this, "--left", "'GLOB'",
             "The left camera's pictures of the grid: a pattern of file names, in the order of their names",
             {}, Takes::kList);
  Option right = Option(this, "--right", "'GLOB'", "The right camera's pictures, as many, in the same order",
                        {}, Takes::kList);
  Option side_by_side = Option(this, "--side-by-side", "'GLOB'",
                               "Instead of --left and --right: pictures that hold the left and the right "
                               "picture of a pair side by side",
                               {}, Takes::kList);
  Option video = Option(this, "--video", "F [F2]",
                        "Instead of pictures: up to 40 pairs of a video of the grid, or of two, the left one "
                        "first",
                        {}, Takes::kList);
  Option video_layout = Option(this, "--video-layout", "LAYOUT",
                               "Where --video has the pictures of a pair: two (files), side_by_side or "
                               "top_bottom (in one file)",
                               {goes_with(video, "F [F2]"), one_of(runs::kVideoLayoutNames)});
  Option synthetic =
      Option(this, "--synthetic", "SEED",
             "Instead of pictures: a synthetic rig with known parameters, another one for each "
             "SEED, 0 or more; also writes its pictures, and those of a scene to run",
             {number<std::uint64_t>(kSeedRule)});
  Option grid = Option(
      this, "--grid", "CxR",
      "The grid: columns x rows of inner corners, where four squares meet (a board of 10x7 squares has 9x6), "
      "or of circles",
      {is_grid()});
  Option pattern = Option(this, "--pattern", "PATTERN",
                          "What the grid shows: chessboard (the default), circles or asymmetric_circles; "
                          "circles are dark on a bright ground",
                          {one_of({calib::kPatternNames.begin(), calib::kPatternNames.end()})});
  Option square =
      Option(this, "--square-mm", "S", "A side of its squares, in millimetres; of circles: from row to row",
             {number<double>("a number")});
  Option disparities = Option(this, "--disparities", "D",
                              "Disparities of the board for which the tables are made, 1..254 (default 80)",
                              {number<int>("an integer, " + kernels::kDisparitiesRule.text(), [](int count) {
                                return kernels::kDisparitiesRule.allows(count);
                              })});
  Option offset = Option(
      this, "--disparity-offset", "auto|N",
      "Columns that the left table subtracts from every disparity (default auto: so that the grid fits; "
      "with --synthetic: 0, which suits its scene)",
      {is_offset()});
  Option print_grid =
      Option(this, "--print-grid", "CxR",
             "Draw such a grid to print, true to scale, with --square-mm and --out alone", {is_grid()});
  Option import = Option(this, "--import", "FILE..",
                         "A calibration that exists, in place of pictures: of OpenCV, ROS (two camera_info), "
                         "Kalibr, Middlebury or KITTI, or one of this program",
                         {}, Takes::kList);
  Option size = Option(this, "--size", "WxH", "With --import: the size of the pictures, if the file has none",
                       {valid("width x height in pixels, such as 640x480",
                              [](const std::string& text) { return size_of(text).has_value(); })});
  Option unit = Option(this, "--unit", "mm|cm|m",
                       "With --import: the unit of T (default: mm of OpenCV and Middlebury, else m)",
                       {one_of({"mm", "cm", "m"})});
  Option lens = Option(this, "--lens", "polynomial|fisheye",
                       "With --import: the lens model of OpenCV's coefficients (default: what the file says, "
                       "else polynomial)",
                       {one_of({"polynomial", "fisheye"})});
  Option cameras =
      Option(this, "--cameras", "LEFT,RIGHT", "With --import of KITTI: the two projections, such as P2,P3",
             {valid("two names with a comma, such as P2,P3", [](const std::string& text) {
               const std::size_t comma = text.find(',');
               return comma > 0 && comma < text.size() - 1;
             })});
  Option near = Option(this, "--near-mm", "Z", "With --import: the nearest depth to see, in mm",
                       {number<double>("a number above 0", [](double depth) { return depth > 0; })});
  Option far = Option(this, "--far-mm", "Z", "With --import: the farthest depth to see, in mm",
                      {number<double>("a number above 0", [](double depth) { return depth > 0; })});
  Option exported = Option(this, "--export", "opencv|ros",
                           "With --import: write a calibration of OpenCV, F.yaml, or of ROS, F_left.yaml and "
                           "F_right.yaml, and no tables",
                           {one_of({"opencv", "ros"})});
  Option out =
      Option(this, "--out", "F.yaml",
             "The calibration; the tables F_left.lut and F_right.lut and the drawings F_drawings/ go beside "
             "it. With "
             "--print-grid the sheet, F.svg");
  Option checked =
      Option(this, "--check", "F.yaml",
             "Print the verdict on a calibration of this program again, from F.yaml and its tables "
             "alone");
};

int leave_unwritten() { return interrupted("nothing was written"); }

int print_grid(const CalibrateOptions& options) {
  const calib::GridShape grid = options.grid_shape();
  process::catch_interrupts();
  const std::string sheet = calib::grid_sheet_svg(grid);
  const files::FileKind kind = {"sheet of the same grid", [&sheet](const fs::path& earlier) {
                                  return files::read_whole_file(earlier) == sheet;
                                }};
  if (!write_out(options.out.text(), kind, sheet)) return leave_unwritten();
  process::print(fmt::format("{}: {}x{} squares of {} mm, {}x{} inner corners; print it at 100 %\n",
                             options.out.text(), grid.columns + 1, grid.rows + 1, grid.square_mm,
                             grid.columns, grid.rows));
  return kDone;
}

class Calibrator {
 public:
  explicit Calibrator(const CalibrateOptions& options)
      : options_(options), files_(runs::rig_files(options.out.text())) {
    request_.grid = options.grid_shape();
    request_.disparities = options.disparities.number<int>().value_or(kDefaultDisparities);
    request_.disparity_offset = options.disparity_offset();
  }

  int run() {
    process::catch_interrupts();
    process::Problems problems;
    load_pictures(problems);
    problems.attempt("--out ", [&] { open_output(); });
    if (process::interrupted()) return leave_unwritten();
    problems.check();
    calibrate();
    for (const std::string& picture : result_.skipped)
      process::say("note", picture + ": the pair is skipped");
    bool is_written = false;
    process::attempt_or_refuse("--out ", [&] {
      write();
      if (process::interrupted()) return;
      output_->commit();
      is_written = true;
    });
    if (!is_written) return leave_unwritten();
    process::print(calibration_summary(result_, request_.pictures.size()) + written_text());
    return kDone;
  }

 private:
  void load_pictures(process::Problems& problems) {
    if (options_.video.is_given()) {
      request_.pictures =
          runs::load_grid_video(options_.video.texts(), options_.video_layout.text(), problems);
      return;
    }
    if (!options_.synthetic.is_given()) {
      request_.pictures = runs::load_grid_pictures(options_.left.texts(), options_.right.texts(),
                                                   options_.side_by_side.texts(), problems);
      return;
    }
    problems.attempt("--synthetic: ", [&] {
      rig_.emplace(*options_.synthetic.number<std::uint64_t>(), kSyntheticWidth, kSyntheticHeight);
      for (int number = 0; number < kSyntheticPairs; ++number) {
        auto [left, right] = rig_->grid_view(request_.grid, number);
        request_.pictures.push_back({files_.pictures / fmt::format("left_{:02}.png", number),
                                     files_.pictures / fmt::format("right_{:02}.png", number),
                                     std::move(left), std::move(right)});
      }
    });
  }

  void open_output() {
    std::vector<files::NamedFile> inputs;
    for (const std::string& file : options_.video.texts()) inputs.push_back({"--video", file});
    if (!rig_ && inputs.empty()) {  // the pictures of a synthetic rig are outputs
      for (const calib::PicturePair& pair : request_.pictures) {
        const bool is_split = options_.side_by_side.is_given();
        inputs.push_back({is_split ? "--side-by-side" : "--left", pair.left_name});
        if (!is_split) inputs.push_back({"--right", pair.right_name});
      }
    }
    fs::path folder = files_.calibration.parent_path();
    if (folder.empty()) folder = ".";
    std::error_code error;
    const fs::file_status status = fs::status(folder, error);
    if (!fs::is_directory(status)) {
      throw std::runtime_error(fmt::format("'{}': {}", folder.string(),
                                           fs::status_known(status) ? "no such folder" : error.message()));
    }
    output_ = std::make_unique<files::OutputFolder>(
        folder, runs::calibration_content(files_, rig_.has_value(), inputs));
  }

  // Calibrates on a separate thread, because OpenCV cannot be stopped: an interrupt ends the process.
  void calibrate() {
    constexpr std::chrono::milliseconds kPollInterval{50};
    const runs::CalibrationFunctions& functions = runs::calibration_functions();
    const std::size_t pictures = 2 * request_.pictures.size();
    std::mutex mutex;
    std::size_t searched = 0;
    std::string last;  // of the pictures searched
    request_.progress = [&](std::size_t count, const std::string& found) {
      const std::lock_guard lock(mutex);
      std::tie(searched, last) = std::tie(count, found);
    };
    auto work = std::async(std::launch::async, [&] {
      result_ = functions.calibrate(request_);
      drawings_ = functions.drawings(request_, result_);
    });
    runs::ProgressLine progress(
        fmt::format("calibration from {} pairs of pictures", request_.pictures.size()));
    const auto show = [&] {
      const std::lock_guard lock(mutex);
      if (searched == pictures) return progress.show_time();
      progress.show(searched, pictures, [&](double seconds) {
        return runs::progress_text(searched, pictures, "pictures searched", seconds) + "; " + last;
      });
    };
    while (work.wait_for(kPollInterval) != std::future_status::ready) {
      show();
      if (!process::interrupted()) continue;
      output_.reset();
      std::_Exit(leave_unwritten());
    }
    process::attempt_or_refuse("", [&] { work.get(); });
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
    for (const auto& [name, png] : drawings_) add(files_.drawings / name, png);
    if (rig_) write_synthetic(files_.pictures);
  }

  // Writes the pictures that the calibration used, and a stereo pair of a scene with the disparities that the
  // board should find.
  void write_synthetic(const fs::path& folder) {
    for (const calib::PicturePair& pictures : request_.pictures) {
      add(pictures.left_name, media::encode_png_gray(pictures.left));
      add(pictures.right_name, media::encode_png_gray(pictures.right));
    }
    const auto scene = rig_->scene();
    add(folder / "scene_left.png", media::encode_png_gray(scene.left));
    add(folder / "scene_right.png", media::encode_png_gray(scene.right));
    const calib::Calibration& made = result_.calibration;
    const media::GreyTruth truth =
        media::truth_of(rig_->disparity(made.rig, made.rectification, made.disparity_offset), made.rig.width,
                        request_.disparities);
    add(folder / "scene_truth.png", media::encode_png_gray(truth.grey));
    truth_scale_ = truth.scale;
  }

  std::string written_text() const {
    std::string text = calibration_row(
        "written", fmt::format("{}, {}, {}, {}/", files_.calibration.string(), files_.left_lut.string(),
                               files_.right_lut.string(), files_.drawings.string()));
    if (!rig_) return text;
    const calib::Rig& known = rig_->rig();
    text += calibration_row("known to be", fmt::format("left focal length {:.1f} px, baseline {:.2f} mm",
                                                       known.left.matrix(0, 0), known.translation.norm()));
    const std::string folder = files_.pictures.string();
    text += fmt::format(
        "{:<16} stereotlm run fpl2003 --source preloaded --set matcher.disparities={} \\\n"
        "{:<16}   --left {}/scene_left.png --right {}/scene_right.png --calibration {} \\\n"
        "{:<16}   --truth {}/scene_truth.png --truth-scale {}\n",
        "to go on", request_.disparities, "", folder, folder, files_.calibration.string(), "", folder,
        truth_scale_);
    return text;
  }

  const CalibrateOptions& options_;
  const runs::RigFiles files_;
  calib::CalibrationRequest request_;
  std::optional<media::SyntheticRig> rig_;
  std::unique_ptr<files::OutputFolder> output_;
  calib::CalibrationResult result_;
  std::map<std::string, std::vector<std::uint8_t>> drawings_;  // by name
  int truth_scale_ = 1;  // grey levels per disparity, of a synthetic rig
};

int check_calibration(const CalibrateOptions& options) {
  process::Problems problems;
  const auto input = runs::load_calibration(options.checked.text(), nullptr, problems, "--check");
  problems.check();
  process::print(calib::verdict_of(*input->calibration) + '\n' + calibration_text(*input->calibration));
  return kDone;
}

int calibrate(const CalibrateOptions& options) {
  if (options.checked.is_given()) return check_calibration(options);
  if (options.import.is_given()) return import_calibration(options.import_request());
  return options.print_grid.is_given() ? print_grid(options) : Calibrator(options).run();
}

}  // namespace

void add_calibrate(Commands& commands) {
  add_command(commands, "calibrate", "Make a board's tables from pictures of a grid, or draw the grid",
              calibrate,
              "Pictures in which the grid is not found whole are named and skipped, with their partners; "
              "corners that\n"
              "do not fit are left out and listed. The grid should be seen in a dozen places, near and far, "
              "tilted, and\n"
              "also at the border of the pictures. An earlier calibration of the same name is replaced.");
}

}  // namespace stereotlm::cli
