#include "tests/support/plain_cycle_loop.h"

#include <vector>

namespace stereotlm::test {

PlainCycleResult run_plain_cycle_loop(const PlainCycleInput& input, int frames,
                                      std::uint64_t max_frame_cycles) {
  PlainCore core(input);
  std::vector<std::uint64_t> frame_cycles;
  std::int64_t start = 0;
  bool hang = false;
  for (int frame = 0; frame < frames && !hang; ++frame) {
    const std::int64_t end = start + static_cast<std::int64_t>(max_frame_cycles);
    std::int64_t now = start;
    for (core.start_frame(frame); core.runs() && now < end; ++now) core.step(now, std::nullopt);
    hang = core.runs();
    if (hang) break;
    const std::int64_t cycles = now - start + input.pipeline_latency_cycles;
    frame_cycles.push_back(static_cast<std::uint64_t>(cycles));
    start += cycles;
  }
  PlainCycleResult result = core.result();
  result.hang = hang;
  result.frame_cycles = frame_cycles;
  return result;
}

}  // namespace stereotlm::test
