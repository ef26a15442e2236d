#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "models/fpga/record/conflict_recorder.h"
#include "platform/config/board_config.h"
#include "platform/records/timeline_records.h"

namespace stereotlm::stats {

// The text of rows.csv: its head, and the lines of one frame. README.md describes the columns.
std::string rows_csv_head(const platform::BoardConfig& board);
std::string rows_csv(const platform::BoardConfig& board, std::uint64_t frame,
                     const fpga::FrameConflicts& conflicts);

// Cells of both files. csv_range(): "first,last" of a part of a whole, such as the rows of a strip.
// csv_tile(): the place of a tile; empty cells for tile 0, the fill.
std::string csv_range(std::size_t index, std::size_t length, int whole);
std::string csv_tile(const platform::BoardConfig& board, const fpga::TileGrid& grid, std::size_t tile);

// The text of conflicts.csv, and its head.
std::string conflicts_csv_head();
std::string conflicts_csv(const platform::BoardConfig& board, const fpga::ConflictRecorder& recorder);

// The heads and the lines of timeline.csv and latency.csv. README.md describes the columns.
std::string timeline_csv_head();
std::string timeline_csv(const std::vector<platform::TimelineEvent>& events);
std::string latency_csv_head();
std::string latency_csv(const std::vector<platform::FrameLatency>& latencies);

}  // namespace stereotlm::stats
