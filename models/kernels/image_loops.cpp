#include "models/kernels/image_loops.h"

#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>

namespace stereotlm::kernels {

extern const ImageLoops image_loops_base;
#ifdef STEREOTLM_X86_IMAGE_LOOPS
extern const ImageLoops image_loops_avx2;
extern const ImageLoops image_loops_avx512;
#endif

namespace {

std::vector<const ImageLoops*> loops_of_this_machine() {
  std::vector<const ImageLoops*> loops;
#ifdef STEREOTLM_X86_IMAGE_LOOPS
  if (__builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl"))
    loops.push_back(&image_loops_avx512);
  if (__builtin_cpu_supports("avx2")) loops.push_back(&image_loops_avx2);
#endif
  loops.push_back(&image_loops_base);
  return loops;
}

// Without those that are better than the one that is wanted.
std::vector<const ImageLoops*> loops_up_to(const char* wanted) {
  std::vector<const ImageLoops*> loops = loops_of_this_machine();
  if (wanted == nullptr) return loops;
  std::string names;
  for (auto found = loops.begin(); found != loops.end(); ++found) {
    if (std::strcmp((*found)->name, wanted) == 0) return {found, loops.end()};
    names += (names.empty() ? "" : ", ") + std::string((*found)->name);
  }
  throw std::invalid_argument(std::string("STEREOTLM_VECTORS = ") + wanted + ": this machine has " + names);
}

}  // namespace

const std::vector<const ImageLoops*>& image_loops() {
  static const std::vector<const ImageLoops*> found = loops_up_to(std::getenv("STEREOTLM_VECTORS"));
  return found;
}

}  // namespace stereotlm::kernels
