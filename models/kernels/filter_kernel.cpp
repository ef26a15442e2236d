#include "models/kernels/filter_kernel.h"

#include <cstddef>
#include <cstdint>
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
  if (kernel.size < 3 || kernel.size > 31 || kernel.size % 2 == 0) {
    found.push_back("kernel size = " + std::to_string(kernel.size) + ": must be odd, 3..31");
  }
  const auto expected = static_cast<std::size_t>(kernel.size) * static_cast<std::size_t>(kernel.size);
  if (kernel.size > 0 && kernel.weights.size() != expected) {
    found.push_back("kernel entries = " + std::to_string(kernel.weights.size()) + ": must be " +
                    std::to_string(kernel.size) + " rows of " + std::to_string(kernel.size));
  }
  for (const int weight : kernel.weights) {
    if (weight < -32768 || weight > 32767) {
      found.push_back("kernel entry = " + std::to_string(weight) + ": must be -32768..32767");
    }
  }
  const auto sum = std::accumulate(kernel.weights.begin(), kernel.weights.end(), std::int64_t{0});
  if (sum != 0) found.push_back("kernel sum = " + std::to_string(sum) + ": must be 0");
  if (kernel.shift < 0 || kernel.shift > 31) {
    found.push_back("shift = " + std::to_string(kernel.shift) + ": must be 0..31");
  }
  return found;
}

}  // namespace stereotlm::kernels
