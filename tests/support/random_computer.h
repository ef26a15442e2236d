#pragma once

#include <cstdint>

#include "tests/support/plain_computer.h"
#include "tests/support/random_board.h"

// Random computers around the boards of random_board.h, for tests that compare the models with the plain
// computer. Each keeps the rules of contract section 4. A seed gives the same one on every platform.
namespace stereotlm::test {

struct RandomComputer {
  RandomBoard board;         // its frames and pictures are not used
  PlainComputerInput input;  // the same board and the computer around it
};

// The number of computers that a test compares: STEREOTLM_RANDOM_COMPUTERS, if that is set.
std::uint64_t random_computers(std::uint64_t without_it);

RandomComputer make_random_computer(std::uint64_t seed, const RandomKnobs& knobs = {});

// The pictures of a camera frame: noise, another one in each frame.
PicturePair camera_pictures(const RandomBoard& board, std::uint64_t frame);

}  // namespace stereotlm::test
