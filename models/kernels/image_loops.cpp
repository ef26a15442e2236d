#include "models/kernels/image_loops.h"

namespace stereotlm::kernels {

extern const ImageLoops image_loops_base;
#ifdef STEREOTLM_X86_IMAGE_LOOPS
extern const ImageLoops image_loops_avx2;
extern const ImageLoops image_loops_avx512;
#endif

const std::vector<const ImageLoops*>& image_loops() {
  static const std::vector<const ImageLoops*> found = [] {
    std::vector<const ImageLoops*> loops;
#ifdef STEREOTLM_X86_IMAGE_LOOPS
    if (__builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl"))
      loops.push_back(&image_loops_avx512);
    if (__builtin_cpu_supports("avx2")) loops.push_back(&image_loops_avx2);
#endif
    loops.push_back(&image_loops_base);
    return loops;
  }();
  return found;
}

}  // namespace stereotlm::kernels
