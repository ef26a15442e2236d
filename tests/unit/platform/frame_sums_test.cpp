#include "platform/frame_sums.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <optional>
#include <vector>

#include "models/fpga/frame_run.h"
#include "tests/unit/fpga/random_core.h"

namespace stereotlm::platform {
namespace {

using fpga::kCorePortCount;

// Two frames without contention: port p has its buffer in bank p in the first frame, in bank 5 - p in the
// second. No table entry is valid, so the pixels take no access.
TEST(FrameSums, AddTheAccessesOfEachFrameToTheBanksOfItsRoutes) {
  const fpga::CoreConfig config = fpga::small_core(16, 6);
  const std::vector<memory::SsramBankConfig> banks(6);
  memory::Arbitration arbitration(fpga::core_arbiter(), banks);
  fpga::FrameRun frames(config, banks, arbitration, UINT64_MAX);
  const fpga::FrameGeometry& geometry = frames.control().geometry();
  fpga::AccessPatterns patterns{fpga::AccessPattern(geometry, config.pixel_cache),
                                fpga::AccessPattern(geometry, config.pixel_cache)};
  const std::vector<std::uint32_t> invalid(16 * 6);
  for (fpga::AccessPattern& pattern : patterns) pattern.set_entries(invalid.data());
  FrameSums sums(banks.size());
  for (const bool reversed : {false, true}) {
    fpga::FrameBases bases{};
    for (std::uint32_t port = 0; port < kCorePortCount; ++port)
      bases[port] = fpga::registers::base(reversed ? 5 - port : port, 0);
    frames.start_direct(reversed ? 10'000 : 0, bases, patterns);
    frames.run_ahead(UINT64_MAX);
    frames.finish();
    sums.add({config, patterns, frames, std::nullopt}, arbitration);
    frames.end();
  }
  sums.add_accesses(3, 7);

  BoardCounters counters;
  counters.banks.resize(banks.size());
  sums.put_into(counters);
  constexpr std::uint64_t kEntries = 3 * 16 * 6 - 2 * 16;  // of each table; the rows outside have none
  constexpr std::uint64_t kResults = 16 * 6 / 4;
  const std::uint64_t expected[] = {kEntries, kEntries + kResults, 0, 7, kEntries + kResults, kEntries};
  for (std::size_t bank = 0; bank < banks.size(); ++bank)
    EXPECT_EQ(counters.banks[bank].accesses, expected[bank]) << bank;
  EXPECT_EQ(counters.left.issued, 2 * geometry.slots);
  EXPECT_EQ(counters.right.issued, 2 * geometry.slots);
  EXPECT_EQ(counters.packed_words, 2 * kResults);
  EXPECT_EQ(counters.written_words, 2 * kResults);
}

}  // namespace
}  // namespace stereotlm::platform
