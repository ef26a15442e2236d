#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tests/support/plain_core.h"
#include "tests/support/plain_cycle_input.h"

// What the plain core says of stalls, as `run --record` must write it. The banks are bank0, bank1, ..
namespace stereotlm::test {

std::string plain_rows_csv(const PlainCycleInput& input, const std::vector<std::vector<PlainStrip>>& frames);
// Of tiles that are larger: `strips` by `groups` of the tiles of PlainCore.
std::string plain_conflicts_csv(const PlainCycleInput& input, const std::vector<PlainTile>& tiles,
                                std::size_t strips = 1, std::size_t groups = 1);

// The lines that differ, at most 20.
std::string differing_lines(const std::string& expected, const std::string& found);

}  // namespace stereotlm::test
