#include "platform/trace_runs.h"

#include <algorithm>
#include <tuple>

namespace stereotlm::platform {
namespace {

// Grants come first, because nothing is less than everything.
bool comes_before(const TraceRun& a, const TraceRun& b) {
  return std::tie(a.strip, a.requester, a.bank, a.by) < std::tie(b.strip, b.requester, b.bank, b.by);
}

}  // namespace

FrameRuns frame_runs(const fpga::FrameConflicts& frame) {
  FrameRuns result;
  result.frame = frame.number;
  result.first_cycle = result.end_cycle = frame.first_cycle;
  for (const fpga::StripConflicts& strip : frame.strips)
    result.strip_ends.push_back(result.end_cycle += strip.cycles);

  const auto add = [&result](std::size_t strip, std::size_t requester, std::size_t bank,
                             std::optional<std::size_t> by, std::uint64_t count) {
    if (count == 0) return;
    const std::uint64_t first = strip == 0 ? result.first_cycle : result.strip_ends[strip - 1];
    result.runs.push_back({strip, first, result.strip_ends[strip], requester, bank, by, count});
  };
  for (std::size_t strip = 0; strip < frame.strips.size(); ++strip) {
    for (std::size_t port = 0; port < fpga::kCorePortCount; ++port)
      add(strip, port, frame.bank_of_port[port], std::nullopt, frame.strips[strip].grants[port]);
    for (std::size_t bank = 0; bank < frame.banks; ++bank) {
      const auto& accesses = frame.accesses[strip * frame.banks + bank];
      for (std::size_t traffic = 0; traffic < fpga::kHostTraffics; ++traffic)
        add(strip, fpga::kCorePortCount + traffic, bank, std::nullopt, accesses[1 + traffic]);
    }
  }
  for (const fpga::FrameConflicts::Stalls& stalls : frame.stalls) {
    const fpga::StallCause& cause = frame.causes[stalls.cause];
    add(stalls.strip, cause.requester, cause.bank, cause.by, stalls.cycles);
  }
  std::sort(result.runs.begin(), result.runs.end(), comes_before);
  return result;
}

}  // namespace stereotlm::platform
