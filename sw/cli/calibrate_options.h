#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "calib/grid_shape.h"
#include "sw/cli/typed_option.h"
#include "sw/process/problems.h"

namespace CLI {
class App;
}

namespace stereotlm::cli {

// Parses and checks the options of `calibrate`.
class CalibrateOptions {
 public:
  // Adds the options to the command, before parsing.
  void add_to(CLI::App& command);

  // To be called in the command's callback: throws Refused if options are wrong.
  void check_usage();

  // Set by check_usage().
  calib::GridShape grid;
  bool print_grid = false;        // only draw the grid into `out`
  std::vector<std::string> left;  // patterns of file names; empty for a synthetic rig
  std::vector<std::string> right;
  std::optional<std::uint64_t> synthetic;  // seed of a synthetic rig
  int disparities = 80;
  std::optional<int> disparity_offset;  // columns; nullopt: auto
  std::string out;

 private:
  void check_grid(const Typed& option, process::Problems& problems);
  void check_square(process::Problems& problems);
  void check_sources(process::Problems& problems);
  void check_numbers(process::Problems& problems);
  void check_out(process::Problems& problems);
  void check_only_with_pictures(process::Problems& problems) const;

  Typed print_grid_;
  Typed grid_;
  Typed square_;
  TypedList left_;
  TypedList right_;
  Typed synthetic_;
  Typed disparities_;
  Typed offset_;
  Typed out_;
};

}  // namespace stereotlm::cli
