#pragma once

#include "models/area/parts.h"
#include "models/kernels/filter_kernel.h"

namespace stereotlm::area {

// The resources of a filter that takes one pixel per cycle, as models/rtl/log_filter.v has it (contract 1.2,
// paper section 2.4). m is the size of the kernel, h its half width. The rows of a column arrive one after
// the other, top first. The parts of the filter:
//   edges    a row of the window has m pixels; beyond an edge of the image it repeats the edge
//   pairs    in a kernel whose rows are symmetric, two pixels of equal weight are added first
//   rows     for each row of the kernel the weighted sum of the m pixels; equal kernel rows share a sum. A
//            weight that is no power of two takes a multiplier of the device; equal products are shared
//   chain    partial result i has the sums for kernel rows 0..i. With each slot it becomes result i+1. Line
//            memories keep m - 1 of them from one strip to the next
//   clamp    results outside 8 bits become 0 or 255
// All sums are as wide as the largest.
struct FilterArithmetic {
  Resources resources;  // including the registers of the chain and of the pipeline
  int chain_bits = 0;   // bits that the line memories keep of a column: of the chain, and h valid bits
};

// `kernel` must have no problems.
FilterArithmetic filter_arithmetic(const kernels::FilterKernel& kernel);

}  // namespace stereotlm::area
