#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "platform/config/board_config.h"
#include "sw/cli/options.h"
#include "sw/process/problems.h"
#include "sw/trace/trace.h"

namespace stereotlm::cli {

// The options --trace and --trace-window.
class TraceOptions {
 public:
  explicit TraceOptions(Options* of);

  // Reports a trace that is none, or whose files another trace writes too, and a vcd without a window.
  void check_together(process::Problems& problems) const;
  // Reports a window outside the images of the board, or after the last of `frames` frames.
  void check_window(const platform::BoardConfig& board, std::uint64_t frames,
                    process::Problems& problems) const;

  // The traces, without those that are none.
  std::vector<trace::TraceFile> files() const;
  // nullopt if there is no window.
  std::optional<trace::TraceWindow> window() const;

 private:
  Option files_;
  Option window_;
};

}  // namespace stereotlm::cli
