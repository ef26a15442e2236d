#include "sw/cli/calibrate_options.h"

#include <fmt/format.h>

#include <filesystem>

#include "models/kernels/limits.h"
#include "sw/cli/add_command.h"
#include "sw/cli/text.h"
#include "sw/runs/sources/rig_files.h"

namespace stereotlm::cli {
namespace {

constexpr const char* kCalibrateExample =
    "stereotlm calibrate --left 'left*.jpg' --right 'right*.jpg' --grid 9x6 --square-mm 25 --out rig.yaml";
constexpr const char* kPrintExample = "stereotlm calibrate --print-grid 9x6 --square-mm 25 --out grid.pdf";

std::string extension_of(const std::string& path) { return std::filesystem::path(path).extension(); }

}  // namespace

void CalibrateOptions::add_to(CLI::App& command) {
  left_.add_to(
      command, "--left", "'GLOB'",
      "The left camera's pictures of the grid: a pattern of file names, in the order of their names");
  left_.takes(1, -1);
  right_.add_to(command, "--right", "'GLOB'", "The right camera's pictures, as many, in the same order");
  right_.takes(1, -1);
  synthetic_.add_to(command, "--synthetic", "SEED",
                    "Instead of pictures: a synthetic rig with known parameters, another one for each "
                    "SEED, 0 or more; also writes its pictures, and those of a scene to run");
  grid_.add_to(
      command, "--grid", "CxR",
      "The grid: columns x rows of inner corners, where four squares meet (a board of 10x7 squares has 9x6)");
  square_.add_to(command, "--square-mm", "S", "A side of its squares, in millimetres");
  disparities_.add_to(command, "--disparities", "D",
                      "Disparities of the board for which the tables are made, 1..254 (default 80)");
  offset_.add_to(
      command, "--disparity-offset", "auto|N",
      "Columns that the left table subtracts from every disparity (default auto: so that the grid fits; "
      "with --synthetic: 0, which suits its scene)");
  print_grid_.add_to(command, "--print-grid", "CxR",
                     "Draw such a grid to print, true to scale, with --square-mm and --out alone");
  out_.add_to(command, "--out", "F.yaml",
              "The calibration; the tables F_left.lut and F_right.lut and the drawings F_drawings/ go beside "
              "it. With "
              "--print-grid the sheet, F.pdf or F.svg");
  set_footer(
      command,
      "Pictures in which the grid is not found whole are named and skipped, with their partners; corners "
      "that\n"
      "do not fit are left out and listed. The grid should be seen in a dozen places, near and far, tilted, "
      "and\n"
      "also at the border of the pictures. An earlier calibration of the same name is replaced.");
}

void CalibrateOptions::check_usage() {
  process::Problems problems;
  print_grid = print_grid_.is_given();
  check_grid(print_grid ? print_grid_ : grid_, problems);
  check_square(problems);
  if (print_grid) {
    check_only_with_pictures(problems);
  } else {
    check_sources(problems);
    check_numbers(problems);
  }
  check_out(problems);
  if (!problems.empty()) {
    problems.add_note(std::string("a complete command: ") + (print_grid ? kPrintExample : kCalibrateExample));
  }
  problems.check();
  for (const std::string& problem : calib::problems(grid)) problems.add(fmt::format("grid: {}", problem));
  problems.check();
}

void CalibrateOptions::check_grid(const Typed& option, process::Problems& problems) {
  const std::string name = print_grid ? "--print-grid" : "--grid";
  if (!option.is_given()) {
    problems.add(name + ": missing: columns x rows of inner corners, such as 9x6");
    return;
  }
  const std::size_t cross = option.text.find('x');
  const auto columns = number_of<int>(std::string_view(option.text).substr(0, cross));
  const auto rows = cross == std::string::npos
                        ? std::nullopt
                        : number_of<int>(std::string_view(option.text).substr(cross + 1));
  if (!columns || !rows) {
    problems.add(
        fmt::format("{} = {}: must be columns x rows of inner corners, such as 9x6", name, option.text));
    return;
  }
  grid.columns = *columns;
  grid.rows = *rows;
}

void CalibrateOptions::check_square(process::Problems& problems) {
  if (!square_.is_given()) {
    problems.add("--square-mm: missing: a side of the grid's squares in millimetres");
    return;
  }
  const auto square = number_of<double>(square_.text);
  if (!square) problems.add(fmt::format("--square-mm = {}: must be a number", square_.text));
  grid.square_mm = square.value_or(0);
}

void CalibrateOptions::check_sources(process::Problems& problems) {
  if (synthetic_.is_given()) {
    synthetic = number_of<std::uint64_t>(synthetic_.text);
    if (!synthetic) {
      problems.add(fmt::format("--synthetic = {}: must be an integer, 0..2^64-1", synthetic_.text));
    }
    if (left_.is_given() || right_.is_given()) {
      problems.add("--synthetic: makes its own pictures: does not go with --left and --right");
    }
    return;
  }
  if (!left_.is_given()) problems.add("--left: missing: the left camera's pictures (or --synthetic SEED)");
  if (!right_.is_given()) problems.add("--right: missing: the right camera's pictures (or --synthetic SEED)");
  left = left_.text;
  right = right_.text;
}

void CalibrateOptions::check_numbers(process::Problems& problems) {
  if (disparities_.is_given()) {
    const auto number = number_of<int>(disparities_.text);
    const kernels::IntegerRule& rule = kernels::kDisparitiesRule;
    if (!number || !rule.allows(*number)) {
      problems.add(fmt::format("--disparities = {}: must be an integer, {}", disparities_.text, rule.text()));
    }
    disparities = number.value_or(disparities);
  }
  if (!offset_.is_given() && synthetic) disparity_offset = 0;
  if (offset_.is_given() && offset_.text != "auto") {
    constexpr int kMost = 2048;  // columns
    disparity_offset = number_of<int>(offset_.text);
    if (!disparity_offset || *disparity_offset < -kMost || *disparity_offset > kMost) {
      problems.add(fmt::format("--disparity-offset = {}: must be auto or an integer, -{}..{}", offset_.text,
                               kMost, kMost));
    }
  }
}

void CalibrateOptions::check_out(process::Problems& problems) {
  if (!out_.is_given()) {
    problems.add(print_grid ? "--out: missing: the sheet, F.pdf or F.svg"
                            : "--out: missing: the calibration, F.yaml");
    return;
  }
  out = out_.text;
  const std::string extension = extension_of(out);
  const bool is_right = print_grid ? extension == ".pdf" || extension == ".svg" : extension == ".yaml";
  if (!is_right) {
    problems.add(fmt::format("--out '{}': must end in {}", out, print_grid ? ".pdf or .svg" : ".yaml"));
  }
}

void CalibrateOptions::check_only_with_pictures(process::Problems& problems) const {
  const auto refuse_if = [&problems](bool is_given, const char* name) {
    if (is_given) problems.add(fmt::format("{}: does not go with --print-grid", name));
  };
  refuse_if(grid_.is_given(), "--grid");
  refuse_if(left_.is_given(), "--left");
  refuse_if(right_.is_given(), "--right");
  refuse_if(synthetic_.is_given(), "--synthetic");
  refuse_if(disparities_.is_given(), "--disparities");
  refuse_if(offset_.is_given(), "--disparity-offset");
}

}  // namespace stereotlm::cli
