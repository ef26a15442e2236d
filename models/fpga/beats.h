#pragma once

#include <cstdint>
#include <systemc>

#include "models/fpga/core_ports.h"
#include "models/kernels/column_scores.h"
#include "models/kernels/pixel_column.h"
#include "models/kernels/words.h"

// The beats of the streams between the stages of the FPGA.
namespace stereotlm::fpga {

// A slot of the sequence: the rectified pixel to fetch.
struct Slot {
  int column = 0;       // of the image
  int row = 0;          // may lie outside the image
  bool empty = false;   // outside the image: no access
  sc_core::sc_time at;  // start of its cycle, from now
};

// The source position of a rectified pixel, if there is one.
struct TableEntry {
  std::uint32_t entry = 0;  // contract 1.1; not valid for an empty slot
};

using kernels::MaskedPixel;
using kernels::PixelColumn;

// From here on a beat belongs to one of the R rows of results of a strip: `row`, 0..R-1.

// The outputs of the window modules for one column.
struct WindowSums {
  int row = 0;                                    // row in the strip
  const std::int32_t* sums = nullptr;             // padded lanes, valid during the push
  int lanes = 0;                                  // padded number of candidates
  const kernels::ColumnScores* scores = nullptr;  // compared in place of the sums, unless null
  int candidates = 0;                             // lanes 0..candidates-1 have windows inside both images
  bool left_valid = false;                        // valid bit of the left pixel in the middle of the window
};

// Unit A's result for a right pixel.
struct RightMatch {
  int row = 0;                                          // row in the strip
  std::uint8_t disparity = kernels::kInvalidDisparity;  // of the pixel, or kInvalidDisparity
};

// Unit B's result for a left pixel.
struct LeftMatch {
  int row = 0;                                          // row in the strip
  std::uint8_t disparity = kernels::kInvalidDisparity;  // of the pixel, or kInvalidDisparity
  bool left_valid = false;                              // valid bit of the pixel's table entry
};

// A checked disparity of a left pixel.
struct Disparity {
  int row = 0;                                      // row in the strip
  std::uint8_t value = kernels::kInvalidDisparity;  // kInvalidDisparity if it failed the check
};

// Four disparities of a row.
struct ResultWord {
  std::uint32_t word = 0;   // the lowest column in the lowest byte
  std::uint64_t place = 0;  // in the disparity buffer, in words
};

}  // namespace stereotlm::fpga
