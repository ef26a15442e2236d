#pragma once

#include "models/host/frame_source.h"
#include "platform/config/board_config.h"
#include "platform/config/tables.h"
#include "tests/support/plain_cycle_loop.h"
#include "tests/support/random_board.h"
#include "tests/support/random_computer.h"

// What the references are told about a board, in the types of the platform. Only this file and those that use
// it know both sides.
namespace stereotlm::test {

// Bank of index i is called "bank<i>" and holds exactly the words of its buffers (one word if it has none). A
// filter of half h gets some kernel of that size.
platform::BoardConfig board_config(const PlainCycleInput& input);
// Throws std::invalid_argument if a side has a bank for its table, but no entries.
platform::Tables board_tables(const PlainCycleInput& input);

// With everything that cycle_input() leaves out.
platform::BoardConfig board_config(const RandomBoard& board);
platform::Tables board_tables(const RandomBoard& board);
host::StereoPair stereo_pair(const RandomBoard& board, int frame);
host::StereoPair stereo_pair(const RandomBoard& board, const PicturePair& pictures);

platform::BoardConfig board_config(const RandomComputer& computer);

}  // namespace stereotlm::test
