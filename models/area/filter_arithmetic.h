#pragma once

#include "models/area/parts.h"
#include "models/kernels/filter_kernel.h"

namespace stereotlm::area {

// The resources of a filter that takes one pixel per cycle (contract 1.2, paper section 2.4). m is the size
// of the kernel, h its half width. The rows of a column arrive one after the other, top first. The parts of
// the filter:
//   pairs    in a kernel whose rows are symmetric, two pixels of equal weight are added first
//   rows     for each row of the kernel the weighted sum of the m new pixels; equal kernel rows share a sum.
//            A weight that is no power of two takes a multiplier of the device
//   chain    m places (transposed filter). Place i adds the sum for kernel row i to a partial result, which
//            moves one place on; the last place completes it. Line memories keep the partial results from one
//            strip to the next, instead of 2h rows of pixels. At the top of a column the adders take them
//            from the line memories, else from the chain; their LUTs have free inputs for this choice
//   clamp    128 is added by inverting a bit; results outside 8 bits become 0 or 255
struct FilterArithmetic {
  Resources resources;  // including the registers of the chain
  int chain_bits = 0;   // bits of the registers of the chain
};

// `kernel` must have no problems.
FilterArithmetic filter_arithmetic(const kernels::FilterKernel& kernel);

}  // namespace stereotlm::area
