#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "platform/bounds.h"
#include "platform/tables.h"
#include "sw/cli/board_options.h"
#include "sw/cli/commands.h"
#include "sw/cli/exit_status.h"
#include "sw/cli/streams.h"

namespace stereotlm::cli {
namespace {

using platform::BoardConfig;
using platform::ResourceBound;

const std::string& in_turn(const std::vector<std::string>& banks, std::uint64_t frame) {
  return banks[frame % banks.size()];
}

std::string frame_lines(const BoardConfig& board, const platform::Tables& tables, std::uint64_t frame) {
  const auto bounds = platform::frame_bounds(board, tables, frame);
  std::uint64_t most = 0;
  std::size_t width = 16;
  for (const ResourceBound& bound : bounds) {
    most = std::max(most, bound.cycles);
    width = std::max(width, bound.resource.size());
  }
  std::string text =
      fmt::format("frame {}: left_image in {}, right_image in {}, disparity in {}\n", frame,
                  in_turn(board.allocation.left_image, frame), in_turn(board.allocation.right_image, frame),
                  in_turn(board.allocation.disparity, frame));
  text +=
      fmt::format("  {:<{}} {:>14} {:>14} {:>12}\n", "resource", width, "cycles", "frames/s", "headroom %");
  for (const ResourceBound& bound : bounds) {
    const auto cycles = static_cast<double>(bound.cycles);
    text += fmt::format("  {:<{}} {:>14} {:>14.3f} {:>12.2f}\n", bound.resource, width, bound.cycles,
                        board.fpga.clock_mhz * 1e6 / cycles, 100 * (1 - cycles / static_cast<double>(most)));
  }
  return text;
}

int bounds(const BoardOptions& options) {
  Problems problems;
  const auto board = options.load(problems);
  problems.check();
  const platform::Tables tables = platform::identity_tables(*board);
  const std::uint64_t frames = platform::allocation_period_frames(*board);
  std::string text;
  for (std::uint64_t frame = 0; frame < frames; ++frame) text += frame_lines(*board, tables, frame);
  const platform::Bound bound = platform::core_bound(*board, tables, frames);
  text +=
      fmt::format("bound of the core: {:.3f} frames/s, limited by {}\n", bound.core, bound.core_limited_by);
  print(text);
  return kDone;
}

}  // namespace

void add_bounds(CLI::App& program, Action& action) {
  CLI::App* command = program.add_subcommand(
      "bounds", "Say what each port and bank of the FPGA core, and its matcher, limit the frame rate to");
  command->footer(
      "For each frame of the allocation's cycle: the fewest FPGA cycles that a frame costs each resource\n"
      "alone, the frames a second that follow, and how much of the slowest resource's time it has to spare.\n"
      "Tables, where the board has them, are taken as the identity.");
  const auto options = std::make_shared<BoardOptions>();
  options->add_to(*command);
  command->callback([options, &action] {
    options->check_usage();
    action = [options] { return bounds(*options); };
  });
}

}  // namespace stereotlm::cli
