#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "sw/files/output_file.h"
#include "sw/trace/change_stream.h"
#include "sw/trace/trace_writer.h"
#include "sw/trace/vcd_signals.h"

namespace stereotlm::trace {

// What a waveform shows.
struct VcdSpan {
  std::uint64_t first_ps = 0;
  std::uint64_t last_ps = 0;
  std::optional<std::uint64_t> wait_ps;  // as in TimeSpan
  std::set<std::string> active_scopes;   // scopes with a signal that has had another value than its idle one
};

// How every file begins.
inline constexpr const char* kVcdMark = "$version stereotlm $end\n$timescale 1 ps $end\n";

// Writes the changes of all streams in the order of their times, as a value change dump of IEEE 1364. A signal
// has at most one change at a time: the last one of its stream.
//
// The file begins and ends with the window, or with the last change if the window has no end. A change before the
// window gives the value with which the window begins. Changes after it are left out.
VcdSpan write_vcd(files::AsideFile& file, const VcdSignals& signals,
                  const std::vector<ChangeStream*>& streams, const TimeSpan& window);

}  // namespace stereotlm::trace
