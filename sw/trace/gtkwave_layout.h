#pragma once

#include <string>

#include "sw/trace/vcd_signals.h"
#include "sw/trace/vcd_text.h"

namespace stereotlm::trace {

// The first line, a comment for GTKWave.
inline constexpr const char* kLayoutMark = "[*] stereotlm";

// A save file of GTKWave for the waveform file of this name in the same folder: the signals of all banks, ports,
// queues and buses that do something in the window, in groups, words as text, the span fitted to the window, and
// the marker where the longest wait begins.
std::string gtkwave_layout(const std::string& file_name, const VcdSignals& signals, const VcdSpan& span);

}  // namespace stereotlm::trace
