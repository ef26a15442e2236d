#pragma once

#include "models/area/parts.h"
#include "models/kernels/filter_kernel.h"

namespace stereotlm::area {

// The arithmetic of the filter for one pixel a cycle (contract 1.2, paper section 2.4), which meets the rows
// of a column one after the other, top first:
//   pairs    in a kernel whose rows read the same from both ends, the two pixels of equal weight are added
//            first
//   rows     the m pixels of the new row, weighted for each row of the kernel; equal rows once. A weight that
//            is no power of two is a multiplier of the device
//   chain    m sums wait for their last row (transposed filter): each new row is added into all of them, and
//            each moves one place on. An adder's LUT has inputs left to choose what line memories kept of it
//   clamp    128 is added by inverting a bit; what leaves 8 bits is set to 0 or 255
// What the chain holds stands for the rows above, so that line memories keep that instead of 2h rows of
// pixels.
struct FilterArithmetic {
  Resources resources;  // the registers of the chain included
  int chain_bits = 0;   // in these registers
};

// The kernel is without problems.
FilterArithmetic filter_arithmetic(const kernels::FilterKernel& kernel);

}  // namespace stereotlm::area
