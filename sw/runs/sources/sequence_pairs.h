#pragma once

#include <string>
#include <vector>

#include "platform/config/board_config.h"
#include "sw/runs/run_json.h"
#include "sw/runs/sources/pair_source.h"

namespace stereotlm::runs {

// The pairs of `--sequence DIR`: left_*.png and right_*.png with the same `*`, sorted by the bytes of their
// names. Other files in the folder are ignored. The first pictures are kept in memory, up to 128 MB. The
// others are decoded again at each use.
class SequencePairs : public PairSource {
 public:
  // Reads every picture once. Throws std::runtime_error if the folder cannot be read, holds no pair or a
  // picture without partner, or holds a picture that cannot be read or has another size than the board's
  // images; the message does not name the option. `board`: null if unknown; sizes are then not checked.
  SequencePairs(const std::string& folder, const platform::BoardConfig* board);

  const InputFolder& input() const { return input_; }  // for run.json
  // The number of pictures that were converted from colour to grey.
  std::uint64_t pictures_converted() const { return converted_; }

 private:
  host::StereoPair load(std::uint64_t index) override;
  kernels::GrayImage load_picture(std::size_t number) const;

  InputFolder input_;  // its files are left and right in turn
  std::uint64_t converted_ = 0;
  std::vector<kernels::GrayImage> kept_;  // pictures of the first files
};

}  // namespace stereotlm::runs
