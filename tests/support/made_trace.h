#pragma once

#include <cstdint>
#include <vector>

#include "models/fpga/record/core_cycle.h"
#include "platform/config/board_config.h"
#include "platform/records/timeline_records.h"
#include "platform/records/trace_records.h"
#include "sw/trace/trace_sink.h"

namespace stereotlm::test {

// The records of a run, made without the simulator: a plain core with one row of results per strip and fixed
// priority, a host that requests a bank in one of 16 cycles, and a few bursts and events around it. Each
// cycle of each frame is there.
struct MadeTrace {
  std::vector<fpga::CoreCycle> cycles;
  std::vector<platform::FrameRuns> frames;
  std::vector<platform::BusBurst> bursts;
  std::vector<platform::QueueLevel> levels;
  std::vector<platform::TimelineEvent> events;

  void send(trace::TraceSink& sink) const;
};

// The requesters of a board with one lane on each side.
inline const fpga::Requesters kRequesters{fpga::CorePorts(1)};
// A cycle in which nothing happens.
fpga::CoreCycle idle_cycle();

// Ends a trace and puts its files in place.
void finish(trace::TraceSink& sink, const trace::TimeSpan& window = {});

// A board of 16x6 pixels, all of whose buffers share two banks.
platform::BoardConfig made_board();
MadeTrace make_trace(const platform::BoardConfig& board, std::uint64_t frames);

}  // namespace stereotlm::test
