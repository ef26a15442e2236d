#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tests/support/plain_clock.h"
#include "tests/support/plain_core.h"
#include "tests/support/plain_cycle_input.h"

// What the plain core says of stalls, as `run --record` must write it, and of energy. The banks are bank0,
// bank1, ..
namespace stereotlm::test {

std::string plain_rows_csv(const PlainCycleInput& input, const std::vector<std::vector<PlainStrip>>& frames);
// Of tiles that are larger: `strips` by `groups` of the tiles of PlainCore.
std::string plain_conflicts_csv(const PlainCycleInput& input, const std::vector<PlainTile>& tiles,
                                std::size_t strips = 1, std::size_t groups = 1);

// Contract section 9: a line for each bank and buffer, and one for all. Of this work, in this time.
std::string plain_energy(const PlainCycleInput& input, const PlainCycleResult& result,
                         const std::vector<PlainBankWork>& work, PlainTime time_ps);

// The lines that differ, at most 20.
std::string differing_lines(const std::string& expected, const std::string& found);

}  // namespace stereotlm::test
