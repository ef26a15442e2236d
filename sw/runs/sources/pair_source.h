#pragma once

#include <cstdint>
#include <limits>
#include <list>
#include <optional>
#include <string>
#include <utility>

#include "models/host/frame_source.h"
#include "platform/config/board_config.h"
#include "sw/media/truth.h"

namespace stereotlm::runs {

// The problem of a picture with this size, as the text that follows its name in a message. nullopt if the
// size fits the board, or if the board is unknown: null.
std::optional<std::string> size_problem(int width, int height, const platform::BoardConfig* board);

// Supplies the pairs of a run: frame f shows pair f mod length(). A pair is loaded when it is requested. Only
// the kHeld pairs that were requested last are kept, so that memory does not grow with the length.
class PairSource : public host::FrameSource {
 public:
  static constexpr std::uint64_t kEndless = std::numeric_limits<std::uint64_t>::max();

  // The number of pairs, 1 or more.
  std::uint64_t length() const { return length_; }

  // The reference is valid until kHeld other pairs have been requested. Throws std::runtime_error with option
  // and path if a file has changed since the source was opened.
  static constexpr std::size_t kHeld = 4;
  const host::StereoPair& pair(std::uint64_t frame) final;

  // The truth of the pair that a frame shows; nullopt if unknown. It holds only for a run without
  // calibration.
  virtual std::optional<media::Truth> truth(std::uint64_t /*frame*/) const { return std::nullopt; }

 protected:
  // `option`: its name in error messages. `length`: 0 if set_length() follows.
  PairSource(std::string option, std::uint64_t length) : option_(std::move(option)), length_(length) {}
  void set_length(std::uint64_t length) { length_ = length; }

 private:
  // Loads pair `index`, 0 .. length()-1.
  virtual host::StereoPair load(std::uint64_t index) = 0;

  struct Held {
    std::uint64_t index = 0;
    host::StereoPair pair;
  };

  std::string option_;
  std::uint64_t length_;
  std::list<Held> held_;  // most recently requested first
};

}  // namespace stereotlm::runs
