#pragma once

#include <string>
#include <vector>

#include "platform/config/board_config.h"
#include "sw/runs/run_json.h"
#include "sw/runs/sources/pair_source.h"

namespace stereotlm::runs {

// The pairs of `--sequence DIR`: left_*.png with right_*.png of the same `*`, in the order of their names,
// byte by byte. Other files in the folder do not matter. The first pictures are kept as they were decoded, up
// to 128 MB; the others are decoded again when they are asked for.
class SequencePairs : public PairSource {
 public:
  // Reads every picture once. Throws std::runtime_error, without the name of the option, if the folder cannot
  // be read, holds no pair or a picture without partner, or for the first picture that cannot be used or is
  // not as large as the board's images. `board`: null if it is not known.
  SequencePairs(const std::string& folder, const platform::BoardConfig* board);

  const InputFolder& input() const { return contents_.input; }              // what run.json says of it
  std::uint64_t pictures_converted() const { return contents_.converted; }  // from colour to grey

 private:
  struct Contents {
    InputFolder input;  // files: left and right in turn
    std::uint64_t converted = 0;
    std::vector<kernels::GrayImage> kept;  // the first ones of the files
  };
  static Contents read(const std::string& folder, const platform::BoardConfig* board);

  explicit SequencePairs(Contents contents);
  host::StereoPair load(std::uint64_t index) override;
  kernels::GrayImage load_picture(std::size_t number) const;

  Contents contents_;
};

}  // namespace stereotlm::runs
