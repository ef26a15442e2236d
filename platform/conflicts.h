#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "models/fpga/conflict_recorder.h"
#include "platform/config/board_config.h"
#include "platform/statistics.h"

namespace stereotlm::platform {

// The ConflictRecorder of a board, with the sums of all that it has handed out.
class Conflicts {
 public:
  // Throws std::invalid_argument if the board has problems.
  explicit Conflicts(const BoardConfig& board, std::size_t most_tiles = fpga::ConflictRecorder::kMostTiles);

  fpga::ConflictRecorder& recorder() { return recorder_; }
  const fpga::ConflictRecorder& recorder() const { return recorder_; }

  // See ConflictRecorder::take_frames().
  std::vector<fpga::FrameConflicts> take_frames();

  // Identities between the sums of tiles and strips, and the figures of the run; those that do not hold. To be
  // called when all frames have been taken.
  std::vector<std::string> failed(const Statistics& statistics) const;

 private:
  fpga::ConflictRecorder recorder_;
  // Of the strips that were taken.
  std::uint64_t frames_ = 0;
  std::uint64_t cycles_ = 0;
  std::array<std::uint64_t, fpga::kRequesters> stalls_{};
  std::vector<std::uint64_t> accesses_;  // [bank]
};

}  // namespace stereotlm::platform
