// Accesses of a stage to many words at once: direct access, changes of watched words, and grants that are
// decided elsewhere.
#include <gtest/gtest.h>

#include <array>
#include <tuple>
#include <vector>

#include "models/testing/expected_report.h"
#include "tests/support/scripted_ends.h"
#include "tests/unit/memory/crossbar_bench.h"

namespace stereotlm::memory {
namespace {

// Words 4 .. 7 of a bank are watched.
class CrossbarWatch : public CrossbarBench {
 protected:
  static constexpr std::uint32_t kFirst = 4;
  static constexpr std::uint32_t kEnd = 8;

  CrossbarWatch() { EXPECT_TRUE(has_changed()); }
  bool has_changed(Port port = port::kLeftLut, std::uint32_t first = kFirst, std::uint32_t end = kEnd) {
    return crossbar->may_have_changed(port, crossbar_address(kPipelined, first),
                                      crossbar_address(kPipelined, end));
  }
  void write(Port port, std::uint32_t word, std::uint64_t cycle, std::size_t bank = kPipelined) {
    route(port, bank, true);
    ASSERT_EQ(arbitrate(cycle, mask_of(port)), mask_of(port));
    ASSERT_EQ(at(port).write(crossbar_address(bank, word), 5).status, tlm::TLM_OK_RESPONSE);
  }
};

TEST_F(CrossbarWatch, ReportsNoChangeAfterTheFirstCallUnlessItIsForOtherWords) {
  EXPECT_FALSE(has_changed());
  EXPECT_FALSE(has_changed());
  EXPECT_TRUE(has_changed(port::kLeftLut, kFirst - 1, kEnd));
  EXPECT_TRUE(has_changed(port::kLeftLut, kFirst - 1, kEnd + 1));
  EXPECT_FALSE(has_changed(port::kLeftLut, kFirst - 1, kEnd + 1));
}

TEST_F(CrossbarWatch, ReportsAWriteToOneOfTheWordsOnce) {
  std::uint64_t cycle = 0;
  for (const Port port : {port::kHost, port::kResult}) {
    for (const std::uint32_t word : {kFirst - 1, kFirst, kEnd - 1, kEnd}) {
      write(port, word, cycle++);
      EXPECT_EQ(has_changed(), word >= kFirst && word < kEnd) << word;
      EXPECT_FALSE(has_changed());
    }
  }
}

TEST_F(CrossbarWatch, IgnoresAWriteToAnotherBankAndReads) {
  write(port::kHost, kFirst, 0, kFlowThrough);
  route(port::kHost, kPipelined, false);
  ASSERT_EQ(arbitrate(1, kHost), kHost);
  at(port::kHost).read(crossbar_address(kPipelined, kFirst));
  at(port::kHost).debug_read(crossbar_address(kPipelined, 0), kWords);
  EXPECT_FALSE(has_changed());
}

TEST_F(CrossbarWatch, ReportsAWriteByDebugTransportThatReachesTheWords) {
  const std::vector<std::uint32_t> words(5);
  for (const auto& [word, count, expected] : {std::tuple{0U, kFirst, false}, std::tuple{0U, kFirst + 1, true},
                                              std::tuple{kEnd - 1, 3U, true}, std::tuple{kEnd, 3U, false}}) {
    at(port::kHost).debug_write(crossbar_address(kPipelined, word), {words.begin(), words.begin() + count});
    EXPECT_EQ(has_changed(), expected) << word << ' ' << count;
  }
}

TEST_F(CrossbarWatch, ReportsDirectWritesThatReachTheWords) {
  const std::uint64_t first = crossbar_address(kPipelined, kFirst);
  for (const auto& [address, bytes, expected] :
       {std::tuple{first - 8, 8U, false}, std::tuple{first - 8, 9U, true},
        std::tuple{first + 16, 4U, false}}) {
    crossbar->changes(address, bytes);
    EXPECT_EQ(has_changed(), expected) << address << ' ' << bytes;
  }
}

TEST_F(CrossbarWatch, ReportsEachChangeToEachPort) {
  EXPECT_TRUE(has_changed(port::kRightLut));
  write(port::kHost, kFirst, 0);
  EXPECT_TRUE(has_changed(port::kLeftLut));
  EXPECT_TRUE(has_changed(port::kRightLut));
  EXPECT_FALSE(has_changed(port::kLeftLut));
}

class CrossbarDirect : public CrossbarBench {};

TEST_F(CrossbarDirect, ReachesTheWordsOfABankAndNoneBeyondItsEnd) {
  const auto* const stored = reinterpret_cast<const unsigned char*>(banks[kFlowThrough]->words());
  const auto direct = [this](std::uint32_t word, std::uint64_t bytes) {
    return crossbar->direct(crossbar_address(kFlowThrough, word), bytes);
  };
  EXPECT_EQ(direct(3, 8), stored + 12);
  EXPECT_EQ(direct(4, 4), stored + 16);
  EXPECT_EQ(direct(kWords - 1, 4), stored + std::size_t{4} * (kWords - 1));
  EXPECT_EQ(direct(kWords, 4), nullptr);
  EXPECT_EQ(direct(0, std::uint64_t{4} * kWords), stored);
  EXPECT_EQ(direct(0, std::uint64_t{4} * kWords + 1), nullptr);
  EXPECT_EQ(accesses(kFlowThrough), 0U);
}

// A bank that grants direct access to its words 0 and 1, or not at all, and revokes it; words 2 and 3 are
// granted separately.
class CrossbarRevoked : public testing::Test {
 protected:
  CrossbarRevoked() {
    binder.bind(crossbar.banks[0], target.socket, "bank");
    target.on_dmi = [this](tlm::tlm_generic_payload& access, tlm::tlm_dmi& dmi) {
      const std::uint64_t start = access.get_address() / 8 * 8;
      unsigned char* const granted = start == 0 ? memory : start == 8 ? memory_behind : nullptr;
      if (granted == nullptr || (reads_only && access.is_write())) return false;
      dmi.set_dmi_ptr(granted);
      dmi.set_start_address(start);
      dmi.set_end_address(start + 7);
      reads_only ? dmi.allow_read() : dmi.allow_read_write();
      return true;
    };
    sc_core::sc_start(sc_core::SC_ZERO_TIME);
  }
  std::array<unsigned char, 8> first{};
  std::array<unsigned char, 8> second{};
  unsigned char* memory = first.data();
  unsigned char* memory_behind = nullptr;
  bool reads_only = false;
  Crossbar crossbar{"crossbar", {kFixedPriority, {{16}}}};
  test::ScriptedTarget target{"target"};
  test::MonitoringBinder binder;
};

TEST_F(CrossbarRevoked, ReachesWordsThatAreGrantedSeparately) {
  memory_behind = second.data();
  EXPECT_EQ(crossbar.direct(0, 8), first.data());
  EXPECT_EQ(crossbar.direct(12, 4), second.data() + 4);
  EXPECT_EQ(crossbar.direct(8, 8), second.data());
  EXPECT_EQ(crossbar.direct(4, 4), first.data() + 4);
  EXPECT_EQ(crossbar.direct(4, 8), nullptr);
}

TEST_F(CrossbarRevoked, ReachesWhatTheBankGrantsAfterItHasRevokedAccess) {
  ASSERT_EQ(crossbar.direct(0, 8), first.data());
  memory = second.data();
  target.socket->invalidate_direct_mem_ptr(0, 7);
  EXPECT_EQ(crossbar.direct(0, 8), second.data());
  memory = nullptr;
  target.socket->invalidate_direct_mem_ptr(0, 7);
  EXPECT_EQ(crossbar.direct(0, 8), nullptr);
  memory = first.data();
  EXPECT_EQ(crossbar.direct(0, 8), first.data());
}

TEST_F(CrossbarRevoked, IsNullForMoreThanTheBankGrants) {
  EXPECT_EQ(crossbar.direct(0, 9), nullptr);
  EXPECT_EQ(crossbar.direct(4, 8), nullptr);
  EXPECT_EQ(crossbar.direct(8, 4), nullptr);
}

TEST_F(CrossbarRevoked, IsNullForWordsThatCanOnlyBeRead) {
  reads_only = true;
  EXPECT_EQ(crossbar.direct(0, 8), nullptr);
}

class CrossbarAim : public CrossbarBench {};

TEST_F(CrossbarAim, LeadsAnAccessOnlyIfThePortIsGranted) {
  const test::ExpectedReport refusal("/stereotlm/refused_access");
  crossbar->aim(port::kHost, kFlowThrough, true);
  const auto write = [this] { return at(port::kHost).write(crossbar_address(kFlowThrough, 2), 9).status; };
  EXPECT_EQ(write(), tlm::TLM_GENERIC_ERROR_RESPONSE);
  crossbar->grant(kHost);
  EXPECT_EQ(write(), tlm::TLM_OK_RESPONSE);
  EXPECT_EQ(write(), tlm::TLM_GENERIC_ERROR_RESPONSE);
  EXPECT_EQ(accesses(kFlowThrough), 1U);
  EXPECT_EQ(banks[kFlowThrough]->words()[2], 9U);
}

TEST_F(CrossbarAim, TakesNoPartInTheArbitration) {
  route(port::kResult, kFlowThrough, true);
  crossbar->aim(port::kHost, kFlowThrough, true);
  EXPECT_FALSE(crossbar->arbitration().is_used_beside(port::kResult, kFlowThrough));
  EXPECT_EQ(arbitrate(0, kHost | kResult), kResult);
}

TEST_F(CrossbarAim, RedirectsTheAccessesOfARoutedPortButNotItsRequests) {
  route(port::kHost, kPipelined, false);
  crossbar->aim(port::kHost, kFlowThrough, false);
  EXPECT_EQ(crossbar->bank_of(port::kHost), kPipelined);
  ASSERT_EQ(arbitrate(0, kHost), kHost);
  EXPECT_EQ(at(port::kHost).read(crossbar_address(kFlowThrough, 0)).status, tlm::TLM_OK_RESPONSE);
}

}  // namespace
}  // namespace stereotlm::memory
