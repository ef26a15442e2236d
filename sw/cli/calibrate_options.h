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

// The options of `calibrate`.
class CalibrateOptions {
 public:
  // Adds them to the command, before it is parsed.
  void add_to(CLI::App& command);

  // While the command's callback runs: throws Refused if they cannot be used.
  void check_usage();

  // As check_usage() leaves them.
  calib::GridShape grid;
  bool print_grid = false;        // only draw the grid, into `out`
  std::vector<std::string> left;  // patterns of file names; none for a rig that is made up
  std::vector<std::string> right;
  std::optional<std::uint64_t> synthetic;  // the seed of that
  int disparities = 80;
  std::optional<int> disparity_offset;  // nothing: auto
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
