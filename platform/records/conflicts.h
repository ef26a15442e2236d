#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "models/fpga/record/conflict_recorder.h"
#include "platform/config/board_config.h"
#include "platform/figures/audit.h"
#include "platform/figures/statistics.h"
#include "platform/records/trace_records.h"

namespace stereotlm::platform {

// Sums of what was recorded of stalls, over the frames.
struct ConflictSums {
  std::uint64_t frames = 0;             // recorded
  std::uint64_t cycles = 0;             // of the strips, as the next two
  std::vector<std::uint64_t> stalls;    // [requester]
  std::vector<std::uint64_t> accesses;  // [bank]
  // Of the tiles: stall cycles by requester, bank and requester to blame.
  std::map<std::array<std::size_t, 3>, std::uint64_t> blame;

  // Check the identities with the figures of the run.
  void check_rows(const fpga::Requesters& requesters, const Statistics& statistics, Audit& audit) const;
  void check_tiles(const fpga::Requesters& requesters, const Statistics& statistics, Audit& audit) const;
};

// The ConflictRecorder of a board, with the sums of all that it has handed out.
class Conflicts {
 public:
  // `most_tiles`: those of a frame that are recorded.
  explicit Conflicts(const BoardConfig& board, std::size_t most_tiles = fpga::ConflictRecorder::kMostTiles);

  fpga::ConflictRecorder& recorder() { return recorder_; }              // to be given to the core
  const fpga::ConflictRecorder& recorder() const { return recorder_; }  // as recorded up to now

  std::vector<fpga::FrameConflicts> take_frames();  // see ConflictRecorder::take_frames()

  // The identities between the sums of tiles and strips and the figures of the run that do not hold. To be
  // called when all frames have been taken.
  std::vector<std::string> failed(const Statistics& statistics) const;

 private:
  fpga::ConflictRecorder recorder_;
  ConflictSums sums_;  // of the frames that were taken, without `blame`
};

// The runs of a frame of the core: its grants and its stalls, strip by strip.
FrameRuns frame_runs(const fpga::FrameConflicts& frame);

}  // namespace stereotlm::platform
