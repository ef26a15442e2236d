#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "models/fpga/core_cycle.h"
#include "platform/config/board_config.h"
#include "sw/trace/trace_writer.h"

namespace stereotlm::trace {

enum class Format : std::uint8_t { kPerfetto, kVcd, kSqlite };
inline constexpr std::array<const char*, 3> kFormatNames = {"perfetto", "vcd", "sqlite"};

// A trace that a run is to write.
struct TraceFile {
  Format format = Format::kPerfetto;
  std::string path;
};

// What the window of a trace shows: these cycles, or those of them around the longest wait of a port.
struct TraceWindow {
  fpga::CycleWindow cycles;
  bool around_longest_wait = false;
};

// The files that the trace is written to, without links: the file itself, and the layout of a waveform. Throws
// std::system_error if links cannot be followed.
std::vector<std::filesystem::path> outputs_of(const TraceFile& file);

// The writer of one or more traces of a run with this window. Throws std::runtime_error, with the name of the file, if one cannot
// be written.
std::unique_ptr<TraceWriter> make_writer(const std::vector<TraceFile>& files,
                                         const platform::BoardConfig& board,
                                         const std::optional<TraceWindow>& window);

}  // namespace stereotlm::trace
