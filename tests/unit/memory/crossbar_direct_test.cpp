// What a stage needs to work on many words at once: direct access, whether they have changed, and grants that
// are decided elsewhere.
#include <gtest/gtest.h>

#include <array>
#include <utility>

#include "tests/unit/memory/crossbar_bench.h"
#include "tests/unit/support/scripted_link.h"

namespace stereotlm::memory {
namespace {

constexpr PortMask kHost = mask_of(Port::kHost);
constexpr PortMask kResult = mask_of(Port::kResult);

// Words 4 .. 7 of a bank are watched.
class CrossbarWatch : public CrossbarBench {
 protected:
  static constexpr std::uint32_t kFirst = 4;
  static constexpr std::uint32_t kEnd = 8;

  bool has_changed(Port port = Port::kLeftLut) {
    return crossbar->may_have_changed(port, crossbar_address(kPipelined, kFirst),
                                      crossbar_address(kPipelined, kEnd));
  }
  void build_and_look() {
    build();
    ASSERT_TRUE(has_changed());
  }
  void write(Port port, std::uint32_t word, std::uint64_t cycle, std::size_t bank = kPipelined) {
    crossbar->route(port, bank, true);
    ASSERT_EQ(arbitrate(cycle, mask_of(port)), mask_of(port));
    ASSERT_EQ(at(port).write(crossbar_address(bank, word), 5).status, tlm::TLM_OK_RESPONSE);
  }
};

TEST_F(CrossbarWatch, SaysYesAtFirstAndNoWhenNothingHappened) {
  build();
  EXPECT_TRUE(has_changed());
  EXPECT_FALSE(has_changed());
  EXPECT_FALSE(has_changed());
}

TEST_F(CrossbarWatch, SaysYesForOtherWords) {
  build_and_look();
  const auto look = [this](std::uint32_t first, std::uint32_t end) {
    return crossbar->may_have_changed(Port::kLeftLut, crossbar_address(kPipelined, first),
                                      crossbar_address(kPipelined, end));
  };
  EXPECT_TRUE(look(kFirst - 1, kEnd));
  EXPECT_TRUE(look(kFirst - 1, kEnd + 1));
  EXPECT_FALSE(look(kFirst - 1, kEnd + 1));
}

TEST_F(CrossbarWatch, SeesAnAccessThatWritesAmongTheWords) {
  build_and_look();
  std::uint64_t cycle = 0;
  for (const Port port : {Port::kHost, Port::kResult}) {
    for (const auto& [word, is_among] : std::array<std::pair<std::uint32_t, bool>, 4>{
             {{kFirst - 1, false}, {kFirst, true}, {kEnd - 1, true}, {kEnd, false}}}) {
      write(port, word, cycle++);
      EXPECT_EQ(has_changed(), is_among) << word;
      EXPECT_FALSE(has_changed());
    }
  }
}

TEST_F(CrossbarWatch, RemembersAWriteBehindWhichOthersCame) {
  build_and_look();
  write(Port::kHost, kFirst, 0);
  write(Port::kHost, kEnd, 1);
  EXPECT_TRUE(has_changed());
}

TEST_F(CrossbarWatch, DoesNotMindAnotherBankOrARead) {
  build_and_look();
  write(Port::kHost, kFirst, 0, kFlowThrough);
  crossbar->route(Port::kHost, kPipelined, false);
  ASSERT_EQ(arbitrate(1, kHost), kHost);
  at(Port::kHost).read(crossbar_address(kPipelined, kFirst));
  at(Port::kHost).debug_read(crossbar_address(kPipelined, 0), kWords);
  EXPECT_FALSE(has_changed());
}

TEST_F(CrossbarWatch, SeesAWriteByDebugTransportOfAsManyWordsAsThereAre) {
  build_and_look();
  at(Port::kHost).debug_write(crossbar_address(kPipelined, 0), {1, 2, 3, 4});
  EXPECT_FALSE(has_changed());
  at(Port::kHost).debug_write(crossbar_address(kPipelined, 0), {1, 2, 3, 4, 5});
  EXPECT_TRUE(has_changed());
  at(Port::kHost).debug_write(crossbar_address(kPipelined, kEnd - 1), {1, 2, 3});
  EXPECT_TRUE(has_changed());
  at(Port::kHost).debug_write(crossbar_address(kPipelined, kEnd), {1, 2, 3});
  EXPECT_FALSE(has_changed());
}

TEST_F(CrossbarWatch, IsToldOfWordsWrittenDirectly) {
  build_and_look();
  crossbar->changes(crossbar_address(kPipelined, 0), std::uint64_t{4} * kFirst);
  EXPECT_FALSE(has_changed());
  crossbar->changes(crossbar_address(kPipelined, 0), std::uint64_t{4} * kFirst + 1);
  EXPECT_TRUE(has_changed());
  crossbar->changes(crossbar_address(kPipelined, kEnd), 4);
  EXPECT_FALSE(has_changed());
}

TEST_F(CrossbarWatch, AlwaysSaysYesOnceTheHostCanWriteDirectly) {
  build_and_look();
  tlm::tlm_dmi dmi;
  ASSERT_TRUE(at(Port::kHost).dmi(crossbar_address(kFlowThrough, 0), dmi));
  EXPECT_FALSE(has_changed());
  ASSERT_TRUE(at(Port::kHost).dmi(crossbar_address(kPipelined, kWords - 1), dmi));
  EXPECT_TRUE(has_changed());
  EXPECT_TRUE(has_changed());
}

TEST_F(CrossbarWatch, TrustsTheStagesThatWorkDirectly) {
  build_and_look();
  tlm::tlm_dmi dmi;
  ASSERT_TRUE(at(Port::kResult).dmi(crossbar_address(kPipelined, 0), dmi));
  EXPECT_FALSE(has_changed());
}

TEST_F(CrossbarWatch, IsEachPortsOwn) {
  build_and_look();
  EXPECT_TRUE(has_changed(Port::kRightLut));
  write(Port::kHost, kFirst, 0);
  EXPECT_TRUE(has_changed(Port::kLeftLut));
  EXPECT_TRUE(has_changed(Port::kRightLut));
  EXPECT_FALSE(has_changed(Port::kLeftLut));
}

class CrossbarDirect : public CrossbarBench {};

TEST_F(CrossbarDirect, ReachesTheWordsOfTheBank) {
  build();
  unsigned char* const words = crossbar->direct(crossbar_address(kFlowThrough, 3), 8);
  ASSERT_NE(words, nullptr);
  EXPECT_EQ(words, reinterpret_cast<const unsigned char*>(banks[kFlowThrough]->words() + 3));
  EXPECT_EQ(crossbar->direct(crossbar_address(kFlowThrough, 4), 4), words + 4);
  EXPECT_EQ(accesses(kFlowThrough), 0U);
}

TEST_F(CrossbarDirect, ReachesAllWordsOfABankAndNoneBehindItsEnd) {
  build();
  EXPECT_NE(crossbar->direct(crossbar_address(kPipelined, 0), std::uint64_t{4} * kWords), nullptr);
  EXPECT_EQ(crossbar->direct(crossbar_address(kPipelined, 0), std::uint64_t{4} * kWords + 1), nullptr);
  EXPECT_EQ(crossbar->direct(crossbar_address(kPipelined, kWords), 4), nullptr);
  EXPECT_NE(crossbar->direct(crossbar_address(kPipelined, kWords - 1), 4), nullptr);
}

TEST_F(CrossbarDirect, CountsWhatItIsToldByBankAndByRoute) {
  build();
  crossbar->route(Port::kLeftPixel, kBurst, false);
  crossbar->count_direct(Port::kLeftPixel, 7);
  crossbar->count_direct(kFlowThrough, 3);
  crossbar->count_direct(kBurst, 1);
  EXPECT_EQ(crossbar->direct_accesses(kPipelined), 0U);
  EXPECT_EQ(crossbar->direct_accesses(kFlowThrough), 3U);
  EXPECT_EQ(crossbar->direct_accesses(kBurst), 8U);
}

// A bank that grants direct access to its words 0 and 1, or not at all, and takes it back; to words 2 and 3
// apart from them.
class CrossbarRevoked : public testing::Test {
 protected:
  CrossbarRevoked() {
    binder.bind(crossbar.banks[0], target.socket, "bank");
    target.on_dmi = [this](tlm::tlm_generic_payload& access, tlm::tlm_dmi& dmi) {
      ++asked;
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
  int asked = 0;
  Crossbar crossbar{"crossbar", {ArbiterConfig{}, {{16}}}};
  test::ScriptedTarget target{"target"};
  test::MonitoringBinder binder;
};

TEST_F(CrossbarRevoked, AsksTheBankOnce) {
  EXPECT_EQ(crossbar.direct(0, 8), first.data());
  EXPECT_EQ(crossbar.direct(4, 4), first.data() + 4);
  EXPECT_EQ(asked, 1);
}

TEST_F(CrossbarRevoked, AsksAgainForWordsThatAreGrantedApart) {
  memory_behind = second.data();
  EXPECT_EQ(crossbar.direct(0, 8), first.data());
  EXPECT_EQ(crossbar.direct(12, 4), second.data() + 4);
  EXPECT_EQ(crossbar.direct(8, 8), second.data());
  EXPECT_EQ(crossbar.direct(4, 4), first.data() + 4);
  EXPECT_EQ(asked, 3);
  EXPECT_EQ(crossbar.direct(4, 8), nullptr);
}

TEST_F(CrossbarRevoked, AsksAgainWhenTheBankHasTakenItBack) {
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

TEST_F(CrossbarAim, LeadsTheAccessOfAPortThatIsGrantedElsewhere) {
  build();
  crossbar->aim(Port::kHost, kFlowThrough, true);
  crossbar->grant(kHost);
  EXPECT_EQ(at(Port::kHost).write(crossbar_address(kFlowThrough, 2), 9).status, tlm::TLM_OK_RESPONSE);
  EXPECT_EQ(banks[kFlowThrough]->words()[2], 9U);
  EXPECT_EQ(at(Port::kHost).write(crossbar_address(kFlowThrough, 2), 9).status,
            tlm::TLM_GENERIC_ERROR_RESPONSE);
}

TEST_F(CrossbarAim, GrantsNothingByItself) {
  build();
  crossbar->aim(Port::kHost, kFlowThrough, true);
  EXPECT_EQ(at(Port::kHost).write(crossbar_address(kFlowThrough, 2), 9).status,
            tlm::TLM_GENERIC_ERROR_RESPONSE);
  EXPECT_EQ(accesses(kFlowThrough), 0U);
}

TEST_F(CrossbarAim, TakesNoPartInTheArbitration) {
  build();
  crossbar->route(Port::kResult, kFlowThrough, true);
  crossbar->aim(Port::kHost, kFlowThrough, true);
  EXPECT_FALSE(crossbar->arbitration().is_used_beside(Port::kResult, kFlowThrough));
  EXPECT_EQ(arbitrate(0, static_cast<PortMask>(kHost | kResult)), kResult);
}

TEST_F(CrossbarAim, ChangesTheWayOfARoutedPortOnly) {
  build();
  crossbar->route(Port::kHost, kPipelined, false);
  crossbar->aim(Port::kHost, kFlowThrough, false);
  EXPECT_EQ(crossbar->bank_of(Port::kHost), kPipelined);
  ASSERT_EQ(arbitrate(0, kHost), kHost);
  EXPECT_EQ(at(Port::kHost).read(crossbar_address(kFlowThrough, 0)).status, tlm::TLM_OK_RESPONSE);
}

}  // namespace
}  // namespace stereotlm::memory
