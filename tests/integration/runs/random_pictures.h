#pragma once

#include <cstdint>

#include "models/host/frame_source.h"
#include "tests/support/board_of_random.h"
#include "tests/support/random_computer.h"

namespace stereotlm::test {

// What the cameras of a random computer see.
class RandomPictures : public host::FrameSource {
 public:
  // `board` outlives this object.
  explicit RandomPictures(const RandomBoard& board) : board_(board) {}
  const host::StereoPair& pair(std::uint64_t number) override {
    pair_ = stereo_pair(board_, camera_pictures(board_, number));
    return pair_;
  }

 private:
  const RandomBoard& board_;
  host::StereoPair pair_;
};

}  // namespace stereotlm::test
