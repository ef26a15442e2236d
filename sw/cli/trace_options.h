#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "platform/config/board_config.h"
#include "sw/cli/typed_option.h"
#include "sw/process/problems.h"
#include "sw/trace/trace.h"

namespace CLI {
class App;
}

namespace stereotlm::cli {

// The options --trace and --trace-window.
class TraceOptions {
 public:
  // Adds the options to a command, before parsing.
  void add_to(CLI::App& command);
  // To be called in the command's callback: reports problems.
  void check_usage(process::Problems& problems);
  // Reports a window outside the images of the board, or after the last of `frames` frames.
  void check_window(const platform::BoardConfig& board, std::uint64_t frames,
                    process::Problems& problems) const;

  // Set by check_usage().
  std::vector<trace::TraceFile> files;
  std::optional<trace::TraceWindow> window;

 private:
  std::optional<std::filesystem::path> shared_output(const trace::TraceFile& file) const;
  void check_files(process::Problems& problems);

  TypedList files_;
  Typed window_;
};

}  // namespace stereotlm::cli
