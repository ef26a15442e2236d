#pragma once

#include "models/host/frame_source.h"
#include "platform/config/board_config.h"
#include "platform/config/tables.h"
#include "platform/figures/statistics.h"
#include "tests/support/plain_cycle_loop.h"
#include "tests/support/random_board.h"
#include "tests/support/random_computer.h"

// Converts the boards of the references to boards of the platform.
namespace stereotlm::test {

// Bank i is called "bank<i>" and is as deep as its buffers need, at least one word. A filter_half of h gives
// some kernel of that size; a cost_half above 0 gives the census of that half.
platform::BoardConfig board_config(const PlainCycleInput& input);
// Throws std::invalid_argument if a side has a bank for its table, but no entries.
platform::Tables board_tables(const PlainCycleInput& input);

// The board with its filter and tolerance, which a PlainCycleInput does not have.
platform::BoardConfig board_config(const RandomBoard& board);
host::StereoPair stereo_pair(const RandomBoard& board, int frame);
host::StereoPair stereo_pair(const RandomBoard& board, const PicturePair& pictures);

platform::BoardConfig board_config(const RandomComputer& computer);

// What plain_energy() says of the same run.
std::string energy_text(const platform::Statistics& run);

}  // namespace stereotlm::test
