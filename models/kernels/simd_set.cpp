// The loops for one instruction set: this file is compiled once for each.
#include "models/kernels/column_simd.h"
#include "models/kernels/correlation_simd.h"
#include "models/kernels/frame_simd_costs.h"
#include "models/kernels/frame_simd_rows.h"

namespace stereotlm::kernels::STEREOTLM_SIMD {

extern const Simd kSimd;
constexpr Simd kSimd = {STEREOTLM_SIMD_NAME, int{kLanes},  rectify,         widen,        add_rows,
                        filter_row,          pair_pixels,  to_lanes,        from_lanes,   check_row,
                        census_row,          sad_loops,    ssd_loops,       census_loops, sad_windows,
                        census_windows,      ssd_windows,  product_windows, step_chain,   smallest_key,
                        filter_column,       add_products, best_candidate};

}  // namespace stereotlm::kernels::STEREOTLM_SIMD
