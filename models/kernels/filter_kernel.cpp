#include "models/kernels/filter_kernel.h"

#include <numeric>

namespace stereotlm::kernels {

FilterKernel log7() {
  return {7,
          {
              0,  -1,  -3,  -5,  -3,  -1,  0,   //
              -1, -6,  -14, -16, -14, -6,  -1,  //
              -3, -14, 0,   35,  0,   -14, -3,  //
              -5, -16, 35,  112, 35,  -16, -5,  //
              -3, -14, 0,   35,  0,   -14, -3,  //
              -1, -6,  -14, -16, -14, -6,  -1,  //
              0,  -1,  -3,  -5,  -3,  -1,  0,
          },
          6};
}

std::vector<std::string> problems(const FilterKernel& kernel) {
  std::vector<std::string> found;
  kKernelSizeRule.check("kernel size", kernel.size, found);
  const auto expected = static_cast<std::size_t>(kernel.size) * static_cast<std::size_t>(kernel.size);
  if (kernel.size > 0 && kernel.weights.size() != expected) {
    found.push_back("kernel entries = " + std::to_string(kernel.weights.size()) + ": must be " +
                    std::to_string(kernel.size) + " rows of " + std::to_string(kernel.size));
  }
  for (const int weight : kernel.weights) kKernelEntryRule.check("kernel entry", weight, found);
  const auto sum = std::accumulate(kernel.weights.begin(), kernel.weights.end(), std::int64_t{0});
  if (sum != 0) found.push_back("kernel sum = " + std::to_string(sum) + ": must be 0");
  kShiftRule.check("shift", kernel.shift, found);
  return found;
}

}  // namespace stereotlm::kernels
