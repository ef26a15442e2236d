#pragma once

#include <string>

#include "sw/trace/vcd_signals.h"
#include "sw/trace/vcd_text.h"

namespace stereotlm::trace {

// A save file of GTKWave for the waveform file of this name in the same folder: all signals in groups, words as
// text, and the span fitted to the window.
std::string gtkwave_layout(const std::string& file_name, const VcdSignals& signals, const VcdSpan& span);

}  // namespace stereotlm::trace
