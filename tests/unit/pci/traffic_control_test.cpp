#include "models/pci/traffic_control.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <utility>

namespace stereotlm::pci {
namespace {

// Keeps the request of the load until the test grants it.
class TrafficControlTest : public testing::Test, public PciSlot {
 protected:
  TrafficControlTest() { load.start(*this); }
  void request(PciMasterIf& master, std::uint64_t from_ps) override {
    EXPECT_EQ(&master, &load);
    EXPECT_FALSE(requested_ps.has_value());
    requested_ps = from_ps;
  }
  BurstResult transferred(std::uint64_t) const override { return {}; }
  const Clock& clock() const override { return clock_; }

  // The load's burst is granted and ends after `words` words. Returns its address and number of words.
  std::pair<std::uint64_t, std::size_t> run_burst(BurstEnd end, std::size_t words, std::uint64_t end_ps) {
    EXPECT_TRUE(requested_ps.has_value());
    const PciBurst burst = load.begin_burst(*requested_ps);
    EXPECT_FALSE(burst.write);
    const std::pair<std::uint64_t, std::size_t> asked = {burst.address, burst.words->size()};
    requested_ps.reset();
    load.end_burst({end, words, 0, end_ps});
    return asked;
  }

  static constexpr std::uint32_t kAddress = 0x1040;
  TrafficControl load{{kAddress, 8, 700, 1000, 0}};
  std::optional<std::uint64_t> requested_ps;

 private:
  Clock clock_{40};
};

TEST_F(TrafficControlTest, RequestsEachTransferAtItsTimeOrAtTheEndOfTheOneBefore) {
  EXPECT_EQ(requested_ps, 700U);
  run_burst(BurstEnd::kComplete, 8, 900);
  EXPECT_EQ(requested_ps, 1700U);
  run_burst(BurstEnd::kComplete, 8, 2700);
  EXPECT_EQ(requested_ps, 2700U);
  run_burst(BurstEnd::kComplete, 8, 3701);
  EXPECT_EQ(requested_ps, 3701U);  // transfer 3 is due at 3700
  run_burst(BurstEnd::kComplete, 8, 3702);
  EXPECT_EQ(requested_ps, 4700U);  // no interval was lost
}

TEST_F(TrafficControlTest, ContinuesAtOnceWhereATransferWasCutDisconnectedOrRetried) {
  EXPECT_EQ(run_burst(BurstEnd::kLatencyTimer, 3, 800),
            std::make_pair(std::uint64_t{kAddress}, std::size_t{8}));
  EXPECT_EQ(requested_ps, 800U);
  EXPECT_EQ(run_burst(BurstEnd::kDisconnect, 0, 850),
            std::make_pair(std::uint64_t{kAddress + 12}, std::size_t{5}));
  EXPECT_EQ(requested_ps, 850U);
  EXPECT_EQ(run_burst(BurstEnd::kDisconnect, 4, 900),
            std::make_pair(std::uint64_t{kAddress + 12}, std::size_t{5}));
  EXPECT_EQ(run_burst(BurstEnd::kComplete, 1, 950),
            std::make_pair(std::uint64_t{kAddress + 28}, std::size_t{1}));
  EXPECT_EQ(requested_ps, 1700U);
  EXPECT_EQ(run_burst(BurstEnd::kComplete, 8, 1800), std::make_pair(std::uint64_t{kAddress}, std::size_t{8}));
}

TEST_F(TrafficControlTest, RequestsNoMoreAfterAnAbort) {
  EXPECT_THROW(run_burst(BurstEnd::kTargetError, 0, 800), std::runtime_error);
  EXPECT_FALSE(requested_ps.has_value());
}

}  // namespace
}  // namespace stereotlm::pci
