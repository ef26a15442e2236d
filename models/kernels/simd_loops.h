#pragma once

#include <cstdint>

#include "models/kernels/column_simd.h"
#include "models/kernels/correlation_simd.h"
#include "models/kernels/frame_simd.h"

// The functions of one instruction set, which FrameSimd and ColumnSimd describe.
namespace stereotlm::kernels::STEREOTLM_SIMD {

void rectify(const std::uint8_t* source, const std::uint32_t* table, int count, int width, std::uint8_t* out);
void add_rows(const std::uint8_t* const* rows, int count, int width, std::int16_t* out);
void filter_row(const std::int16_t* const* rows, const FilterTaps& taps, int width, std::uint8_t* out);

void pair_pixels(const std::uint8_t* entering, const std::uint8_t* leaving, int width, std::int16_t* out);
void to_lanes(const std::int16_t* const* from, int count, std::int16_t* out);
void from_lanes(const std::int16_t* from, int count, std::uint8_t* const* out);
void check_row(const std::uint8_t* left_based, const std::uint8_t* right_based,
               const std::uint32_t* left_table, int count, int tolerance, std::uint8_t* out);
void census_row(const std::int8_t* const* rows, int half, int width, std::uint8_t* const* out);
MatchLoops sad_loops(int window);
MatchLoops ssd_loops(int window);
MatchLoops zncc_loops(int window);
MatchLoops census_loops(int planes, int window);

void sad_windows(const std::uint8_t* const* histories, const std::uint8_t* left, int rows, int lanes,
                 std::int16_t* leaving, std::int32_t* windows);
void census_windows(const std::uint8_t* const* histories, const std::uint8_t* left, int rows, int lanes,
                    std::int16_t* leaving, std::int32_t* windows);
void ssd_windows(const std::uint8_t* const* histories, const std::uint8_t* left, int rows, int lanes,
                 std::int32_t* leaving, std::int32_t* windows);
void product_windows(const std::uint8_t* const* histories, const std::uint8_t* left, int rows, int lanes,
                     std::int32_t* leaving, std::int32_t* windows);
void step_chain(const std::int32_t* sums, int candidates, int lanes, const std::int32_t* held,
                std::int32_t* next);
std::int32_t smallest_key(const std::int32_t* sums, int candidates, int lanes);
void filter_column(const float* columns, std::ptrdiff_t stride, const float* weights, int size, int rows,
                   int shift, std::uint8_t* out);

void add_products(const std::uint8_t* const* rows, const std::int16_t* own, int pairs, int lanes,
                  std::int32_t* column, const std::int32_t* leaving, std::int32_t* window);
int best_candidate(const Candidates& candidates, const std::int32_t* products, double pixels, double own_sum,
                   double* quotients);

}  // namespace stereotlm::kernels::STEREOTLM_SIMD
