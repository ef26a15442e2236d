#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "models/fpga/record/core_cycle.h"
#include "models/fpga/stereo_core.h"
#include "models/host/frame_source.h"
#include "platform/config/board_config.h"
#include "platform/config/tables.h"
#include "platform/figures/statistics.h"
#include "platform/records/conflicts.h"
#include "tests/support/plain_cycle_loop.h"

namespace stereotlm::test {

struct PreloadedRun {
  platform::Statistics statistics;
  std::vector<kernels::GrayImage> disparity;  // per frame
  std::vector<fpga::RowProfile> rows;         // per frame, if they were asked for
};

// Simulates `frames` frames, frame f with pair f mod length, every memory-mapped link under a protocol
// monitor (a violation fails the test). `observer`: of all cycles of the frames; needs `conflicts`. Once per
// process.
PreloadedRun run_preloaded(const platform::BoardConfig& board, const platform::Tables& tables,
                           const std::vector<host::StereoPair>& pairs, std::uint64_t frames,
                           fpga::Fidelity fidelity = fpga::Fidelity::kCycle, bool with_rows = false,
                           platform::Conflicts* conflicts = nullptr, fpga::CycleObserver* observer = nullptr);

// Every counter under a name of its own, "left_lut granted", "bank0 reads", "left_lut blames result in
// bank0", "frame 0 cycles": of the model and of the plain loop alike.
using Figures = std::map<std::string, std::uint64_t>;
Figures figures(const platform::Statistics& statistics);
Figures figures(const PlainCycleResult& result);

// One line for each figure that is not the same in both; empty if all are.
std::string differences(const Figures& model, const Figures& expected);

}  // namespace stereotlm::test
