#include "models/kernels/simd.h"

#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>

namespace stereotlm::kernels {

namespace base {
extern const Simd kSimd;
}
#ifdef STEREOTLM_X86_SIMD
namespace avx2 {
extern const Simd kSimd;
}
namespace avx512 {
extern const Simd kSimd;
}
#endif

namespace {

std::vector<const Simd*> sets_of_this_machine() {
  std::vector<const Simd*> sets;
#ifdef STEREOTLM_X86_SIMD
  const bool has_avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  if (has_avx2 && __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl"))
    sets.push_back(&avx512::kSimd);
  if (has_avx2) sets.push_back(&avx2::kSimd);
#endif
  sets.push_back(&base::kSimd);
  return sets;
}

}  // namespace

std::vector<const Simd*> simd_sets_from(const char* best) {
  std::vector<const Simd*> sets = sets_of_this_machine();
  if (best == nullptr) return sets;
  std::string names;
  for (auto set = sets.begin(); set != sets.end(); ++set) {
    if (std::strcmp((*set)->name, best) == 0) return {set, sets.end()};
    names += (names.empty() ? "" : ", ") + std::string((*set)->name);
  }
  throw std::invalid_argument(std::string("STEREOTLM_VECTORS = ") + best + ": this machine has " + names);
}

const std::vector<const Simd*>& simd_sets() {
  static const std::vector<const Simd*> sets = simd_sets_from(std::getenv("STEREOTLM_VECTORS"));
  return sets;
}

}  // namespace stereotlm::kernels
