#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "platform/config/board_config.h"

namespace stereotlm::explore {

// What a key of a board can change. Figures that depend on none of it are equal on boards that differ in the
// key.
struct KeyEffects {
  bool disparities = false;    // of the core
  bool core_cycles = false;    // cycles of a frame of the core alone
  bool computer_time = false;  // anything that happens in the whole computer
  bool area = false;           // FPGA resources, and the device with its shares
  bool pins = false;
  bool energy = false;  // of the memories, beyond what the accesses and the time change
};

// Of a key as board_keys() has it. Throws std::out_of_range for a path that is no key with a value.
const KeyEffects& effects_of_key(const std::string& schema_path);

// Boards with the same text take the same cycles for each frame of the core alone. Of the banks only those
// that hold a buffer matter.
std::string core_cycles_key(const platform::BoardConfig& board);
// Computers with the same text do the same at the same time, but for the accesses of their cores, if the
// frames of both are apart (platform::frames_are_apart()). `frame_cycles`: of the core alone, for a turn of
// the lists.
std::string computer_time_key(const platform::BoardConfig& board,
                              const std::vector<std::uint64_t>& frame_cycles);
// core_cycles_key() if no port ever waits for a bank: of the banks only the read latency of each buffer
// matters.
std::string waitless_key(const platform::BoardConfig& board);

}  // namespace stereotlm::explore
