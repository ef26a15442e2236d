#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sw/trace/change_stream.h"
#include "sw/trace/output_file.h"
#include "sw/trace/vcd_signals.h"

namespace stereotlm::trace {

// The first and the last time at which a signal changes.
struct VcdSpan {
  std::uint64_t first_ps = 0;
  std::uint64_t last_ps = 0;
};

// Writes the changes of all streams in the order of their times, as a value change dump of IEEE 1364. A signal
// has at most one change at a time: the last one of its stream.
VcdSpan write_vcd(OutputFile& file, const VcdSignals& signals, const std::vector<ChangeStream*>& streams);

}  // namespace stereotlm::trace
