#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "models/fpga/conflict_recorder.h"
#include "platform/config/board_config.h"

namespace stereotlm::report {

// The text of rows.csv: its head, and the lines of one frame. README.md describes the columns.
std::string rows_csv_head(const platform::BoardConfig& board);
std::string rows_csv(const platform::BoardConfig& board, std::uint64_t frame,
                     const fpga::FrameConflicts& conflicts);

// The text of conflicts.csv, and its head.
std::string conflicts_csv_head();
std::string conflicts_csv(const platform::BoardConfig& board, const fpga::ConflictRecorder& recorder);
// The same text in pieces of some 64 kB, because the whole can have tens of MB.
void conflicts_csv(const platform::BoardConfig& board, const fpga::ConflictRecorder& recorder,
                   const std::function<void(const std::string& piece)>& take);

}  // namespace stereotlm::report
