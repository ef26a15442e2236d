#pragma once

#include <type_traits>

#include "models/kernels/column_simd.h"
#include "models/kernels/correlation_simd.h"
#include "models/kernels/frame_simd.h"

// The functions of one instruction set. FrameSimd, ColumnSimd and CorrelationSimd describe them.
namespace stereotlm::kernels::STEREOTLM_SIMD {

template <class Pointer>
using FunctionOf = std::remove_pointer_t<Pointer>;

FunctionOf<decltype(FrameSimd::rectify)> rectify;
FunctionOf<decltype(FrameSimd::add_rows)> add_rows;
FunctionOf<decltype(FrameSimd::filter_row)> filter_row;
FunctionOf<decltype(FrameSimd::pair_pixels)> pair_pixels;
FunctionOf<decltype(FrameSimd::to_lanes)> to_lanes;
FunctionOf<decltype(FrameSimd::from_lanes)> from_lanes;
FunctionOf<decltype(FrameSimd::check_row)> check_row;
FunctionOf<decltype(FrameSimd::census_row)> census_row;
FunctionOf<decltype(FrameSimd::sad_loops)> sad_loops;
FunctionOf<decltype(FrameSimd::ssd_loops)> ssd_loops;
FunctionOf<decltype(FrameSimd::zncc_loops)> zncc_loops;
FunctionOf<decltype(FrameSimd::census_loops)> census_loops;

FunctionOf<decltype(ColumnSimd::sad_windows)> sad_windows;
FunctionOf<decltype(ColumnSimd::census_windows)> census_windows;
FunctionOf<decltype(ColumnSimd::ssd_windows)> ssd_windows;
FunctionOf<decltype(ColumnSimd::product_windows)> product_windows;
FunctionOf<decltype(ColumnSimd::step_chain)> step_chain;
FunctionOf<decltype(ColumnSimd::smallest_key)> smallest_key;
FunctionOf<decltype(ColumnSimd::filter_column)> filter_column;

FunctionOf<decltype(CorrelationSimd::add_products)> add_products;
FunctionOf<decltype(CorrelationSimd::best_candidate)> best_candidate;

}  // namespace stereotlm::kernels::STEREOTLM_SIMD
