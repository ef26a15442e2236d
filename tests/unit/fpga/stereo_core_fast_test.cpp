// What is special where the data of a frame is worked on at once: frames that cannot be, bursts that would
// notice, and tables that have changed since the last one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/expected_report.h"
#include "tests/support/fork.h"
#include "tests/unit/fpga/core_figures.h"
#include "tests/unit/fpga/stereo_core_bench.h"

namespace stereotlm::fpga {
namespace {

using kernels::kEntryValid;
using memory::crossbar_address;
using memory::Port;
using tlm::TLM_READ_COMMAND;
using tlm::TLM_WRITE_COMMAND;
using Words = std::vector<std::uint32_t>;

constexpr std::uint32_t kImageWords = 12;  // of 8 x 6 pixels
constexpr std::uint32_t kTableWords = 48;

// Lets direct access through to a bank as long as it is open.
class DirectAccessGate : public sc_core::sc_module,
                         public tlm::tlm_fw_transport_if<>,
                         public tlm::tlm_bw_transport_if<> {
 public:
  tlm::tlm_target_socket<32> in{"in"};
  tlm::tlm_initiator_socket<32> out{"out"};
  explicit DirectAccessGate(const sc_core::sc_module_name& name, bool is_open = true)
      : sc_module(name), is_open_(is_open) {
    in.bind(*this);
    out.bind(*this);
  }
  void close() {
    is_open_ = false;
    in->invalidate_direct_mem_ptr(0, UINT64_MAX);
  }

 private:
  void b_transport(tlm::tlm_generic_payload& access, sc_core::sc_time& delay) override {
    out->b_transport(access, delay);
  }
  tlm::tlm_sync_enum nb_transport_fw(tlm::tlm_generic_payload& access, tlm::tlm_phase& phase,
                                     sc_core::sc_time& delay) override {
    return out->nb_transport_fw(access, phase, delay);
  }
  unsigned transport_dbg(tlm::tlm_generic_payload& access) override { return out->transport_dbg(access); }
  bool get_direct_mem_ptr(tlm::tlm_generic_payload& access, tlm::tlm_dmi& dmi) override {
    if (is_open_) return out->get_direct_mem_ptr(access, dmi);
    dmi.init();
    return false;
  }
  tlm::tlm_sync_enum nb_transport_bw(tlm::tlm_generic_payload& access, tlm::tlm_phase& phase,
                                     sc_core::sc_time& delay) override {
    return in->nb_transport_bw(access, phase, delay);
  }
  void invalidate_direct_mem_ptr(sc_dt::uint64 start, sc_dt::uint64 end) override {
    in->invalidate_direct_mem_ptr(start, end);
  }

  bool is_open_;
};

class StereoCoreFast : public StereoCoreBench {
 protected:
  Fidelity fidelity() const override { return Fidelity::kFast; }

  // Whether the accesses of the last frames were transported to the banks, word by word.
  bool is_transported() const {
    std::uint64_t transported = 0;
    std::uint64_t direct = 0;
    for (std::size_t bank = 0; bank < banks.size(); ++bank) {
      transported += banks[bank]->stats().reads + banks[bank]->stats().writes;
      direct += core->crossbar().direct_accesses(bank);
    }
    EXPECT_NE(transported == 0, direct == 0) << transported << ", " << direct;
    EXPECT_EQ(core->stepped_frames(), direct == 0 ? core->frame_cycles().size() : 0);
    return direct == 0;
  }
  Words result_words() { return memory.debug_read(crossbar_address(kResult, 0), kImageWords); }
};

TEST_F(StereoCoreFast, TransportsNoWord) {
  build(small_board());
  start();
  finish();
  EXPECT_FALSE(is_transported());
  EXPECT_EQ(status(), registers::kStatusDone);
}

TEST_F(StereoCoreFast, TransportsTheWordsOfAFrameWhoseDisparitiesOverlapAnImage) {
  build(small_board());
  set_base(registers::kDisparityBase, kLeft, kImageWords - 1);
  start();
  finish();
  EXPECT_TRUE(is_transported());
}

TEST_F(StereoCoreFast, WorksAtOnceOnAFrameWhoseDisparitiesLieRightBehindAnImage) {
  build(small_board());
  set_base(registers::kDisparityBase, kLeft, kImageWords);
  start();
  finish();
  EXPECT_FALSE(is_transported());
}

TEST_F(StereoCoreFast, TransportsTheWordsOfAFrameWhoseDisparitiesOverlapATable) {
  build(small_board());
  set_base(registers::kDisparityBase, kRightTable, kTableWords - 1);
  start();
  finish();
  EXPECT_TRUE(is_transported());
}

TEST_F(StereoCoreFast, TransportsTheWordsOfAFrameWithAnEntryThatPointsOutsideTheImage) {
  build(small_board());
  memory.debug_write(crossbar_address(kLeftTable, 5), {kernels::make_entry(8, 0)});
  start();
  finish();
  EXPECT_TRUE(is_transported());
}

TEST_F(StereoCoreFast, MindsNoEntryOutsideTheImageThatIsNotValid) {
  build(small_board());
  memory.debug_write(crossbar_address(kLeftTable, 5), {kernels::make_entry(8, 6) & ~kEntryValid});
  start();
  finish();
  EXPECT_FALSE(is_transported());
}

TEST_F(StereoCoreFast, WorksAtOnceAgainOnTheNextFrameThatCanBe) {
  build(small_board());
  set_base(registers::kDisparityBase, kLeft, 0);
  start();
  finish();
  const std::uint64_t transported = banks[kRight]->stats().reads;
  ASSERT_GT(transported, 0U);
  set_base(registers::kDisparityBase, kResult, 0);
  start();
  finish();
  EXPECT_EQ(banks[kRight]->stats().reads, transported);
  EXPECT_EQ(core->stepped_frames(), 1U);
  EXPECT_EQ(core->frame_cycles().back(), frame_cycles_alone(4));
}

// Changes to a table between two frames: the second one has no valid entry, and so no disparities and no
// reads of the image.
class StereoCoreTables : public StereoCoreFast {
 protected:
  void run_first() {
    build(small_board());
    start();
    finish();
    ASSERT_EQ(result_words().size(), kImageWords);
    reads_ = port(Port::kLeftPixel).granted();
    ASSERT_GT(reads_, 0U);
  }
  void expect_noticed() {
    start();
    finish();
    EXPECT_EQ(result_words(), Words(kImageWords, 0xFFFF'FFFF));
    EXPECT_EQ(port(Port::kLeftPixel).granted(), reads_);
  }

 private:
  std::uint64_t reads_ = 0;
};

TEST_F(StereoCoreTables, ThatTheLocalBusChangesAreReadAgain) {
  run_first();
  at(sc_core::sc_time_stamp(),
     [this] { memory.access(TLM_WRITE_COMMAND, crossbar_address(kLeftTable, 0), Words(kTableWords)); });
  finish();
  expect_noticed();
}

TEST_F(StereoCoreTables, ThatDebugTransportChangesAreReadAgain) {
  run_first();
  memory.debug_write(crossbar_address(kLeftTable, 0), Words(kTableWords));
  expect_noticed();
}

TEST_F(StereoCoreTables, ThatAreChangedDirectlyAreReadAgain) {
  run_first();
  tlm::tlm_dmi dmi;
  ASSERT_TRUE(memory.dmi(crossbar_address(kLeftTable, 0), dmi));
  std::fill_n(dmi.get_dmi_ptr(), kTableWords * 4, std::uint8_t{0});
  expect_noticed();
}

TEST_F(StereoCoreTables, ThatLieElsewhereAreReadAgain) {
  run_first();
  set_base(registers::kLeftLutBase, kSpare);
  expect_noticed();
}

TEST_F(StereoCoreTables, ThatAFrameOverwritesAreReadAgain) {
  run_first();
  // A frame on black tables leaves 0xFF everywhere; its words are entries that point outside the image.
  set_base(registers::kLeftLutBase, kSpare);
  set_base(registers::kDisparityBase, kLeftTable);
  start();
  finish();
  set_base(registers::kLeftLutBase, kLeftTable);
  set_base(registers::kDisparityBase, kResult);
  const std::uint64_t transported = banks[kRight]->stats().reads;
  start();
  finish();
  EXPECT_GT(banks[kRight]->stats().reads, transported);
}

// Bursts of the local bus during a frame that would notice what is done at once.
class StereoCoreBursts : public StereoCoreFast {
 protected:
  void SetUp() override {
    sc_core::sc_report_handler::set_actions("/stereotlm/core", sc_core::SC_ERROR, sc_core::SC_DO_NOTHING);
  }
  void run_with(tlm::tlm_command command, Bank bank, std::uint32_t word, std::size_t words = 1) {
    build(small_board());
    at(edge(0), [this] { start(); });
    at(edge(10), [this, command, bank, word, words] {
      memory.access(command, crossbar_address(bank, word), Words(words));
    });
    finish();
    ASSERT_EQ(memory.answers.size(), 1U);
    EXPECT_EQ(core->frame_cycles().size(), 1U);
  }
  bool ended_with_error() { return (status() & registers::kStatusError) != 0; }
  void expect_reported(tlm::tlm_command command, Bank bank, std::uint32_t word, const std::string& text) {
    const test::ExpectedReport expected("/stereotlm/core");
    run_with(command, bank, word);
    EXPECT_EQ(expected.text(), "core: a burst of the local bus " + text + ": needs fidelity cycle");
    EXPECT_TRUE(ended_with_error());
    // The next one is not to blame.
    start();
    finish();
    EXPECT_EQ(status(), registers::kStatusDone);
  }
};

TEST_F(StereoCoreBursts, ThatWriteTheLeftImageAreReported) {
  expect_reported(TLM_WRITE_COMMAND, kLeft, kImageWords - 1,
                  "writes words 11..11 of bank number 0, where the running frame has its left_image");
}
TEST_F(StereoCoreBursts, ThatWriteTheRightImageAreReported) {
  expect_reported(TLM_WRITE_COMMAND, kRight, 0,
                  "writes words 0..0 of bank number 1, where the running frame has its right_image");
}
TEST_F(StereoCoreBursts, ThatWriteTheLeftTableAreReported) {
  expect_reported(TLM_WRITE_COMMAND, kLeftTable, kTableWords - 1,
                  "writes words 47..47 of bank number 3, where the running frame has its left_lut");
}
TEST_F(StereoCoreBursts, ThatWriteTheRightTableAreReported) {
  expect_reported(TLM_WRITE_COMMAND, kRightTable, 0,
                  "writes words 0..0 of bank number 4, where the running frame has its right_lut");
}
TEST_F(StereoCoreBursts, ThatReadTheDisparitiesAreReported) {
  expect_reported(TLM_READ_COMMAND, kResult, kImageWords - 1,
                  "reads words 11..11 of bank number 2, where the running frame has its disparity");
}
TEST_F(StereoCoreBursts, ThatWriteTheDisparitiesAreReported) {
  expect_reported(TLM_WRITE_COMMAND, kResult, 0,
                  "writes words 0..0 of bank number 2, where the running frame has its disparity");
}
TEST_F(StereoCoreBursts, ThatReadWhatTheFrameReadsAreServed) {
  run_with(TLM_READ_COMMAND, kLeft, 0);
  EXPECT_EQ(memory.answers[0].word, words_of(left)[0]);
  EXPECT_FALSE(ended_with_error());
}
TEST_F(StereoCoreBursts, ThatWriteRightBehindABufferAreServed) {
  run_with(TLM_WRITE_COMMAND, kLeftTable, kTableWords, 2);
  EXPECT_EQ(memory.answers[0].status, tlm::TLM_OK_RESPONSE);
}

// Direct access to the disparities that ends while a frame runs.
class StereoCoreDirectAccess : public StereoCoreFast {
 protected:
  void SetUp() override {
    sc_core::sc_report_handler::set_actions("/stereotlm/core", sc_core::SC_ERROR, sc_core::SC_DO_NOTHING);
  }
  void bind_bank(InitiatorSocket& from, TargetSocket& to, const std::string& link) override {
    gates_.push_back(std::make_unique<DirectAccessGate>((link + "_gate").c_str()));
    from.bind(gates_.back()->in);
    binder.bind(gates_.back()->out, to, link);
  }
  DirectAccessGate& gate(Bank bank) { return *gates_[bank]; }

 private:
  std::vector<std::unique_ptr<DirectAccessGate>> gates_;
};

TEST_F(StereoCoreDirectAccess, TakenBackWithinAFrameIsReportedAndRaisesError) {
  build(small_board());
  memory.debug_write(crossbar_address(kResult, 0), Words(kImageWords, 77));
  at(edge(0), [this] { start(); });
  at(edge(10), [this] { gate(kResult).close(); });
  {
    const test::ExpectedReport expected("/stereotlm/core");
    finish();
    EXPECT_EQ(expected.text(), "core: direct access to the disparities was taken back within a frame");
  }
  EXPECT_EQ(status(), registers::kStatusDone | registers::kStatusError);
  EXPECT_EQ(result_words(), Words(kImageWords, 77));
  EXPECT_EQ(core->frame_cycles(), std::vector<std::uint64_t>{frame_cycles_alone(4)});
  // Its counts are those of the cycles.
  EXPECT_EQ(core->result_writer().stats().writes, kImageWords);
  EXPECT_EQ(accesses(kResult), port(Port::kResult).granted());
  start();
  finish();
  EXPECT_EQ(status(), registers::kStatusDone);
  EXPECT_EQ(core->stepped_frames(), 1U);
}

// Brings control() up to the present while a frame runs.
class StereoCoreCatchUp : public StereoCoreFidelities {};

TEST_P(StereoCoreCatchUp, ShowsTheSlotsOfThePresent) {
  build(small_board());
  at(edge(0), [this] { start(); });
  memory.debug_write(crossbar_address(kLeftTable, 8), Words(4));  // entries that are not valid
  std::vector<std::uint64_t> consumed;
  std::vector<std::uint64_t> handled;
  for (const std::uint64_t cycle : {3U, 4U, 5U, 30U, 90U}) {
    at(edge(cycle) + sc_core::sc_time::from_value(2), [this, &consumed, &handled] {
      core->catch_up();
      consumed.push_back(core->control().left().consumed());
      handled.push_back(port(Port::kLeftPixel).granted() + port(Port::kLeftPixel).passed());
    });
  }
  finish();
  // With tables the matcher consumes from cycle 4 on, a slot a cycle; cycle 4 itself has begun.
  EXPECT_EQ(consumed, (std::vector<std::uint64_t>{0, 1, 2, 27, 87}));
  EXPECT_EQ(handled, (std::vector<std::uint64_t>{2, 3, 4, 29, 89}));
  EXPECT_EQ(core->frame_cycles(), std::vector<std::uint64_t>{frame_cycles_alone(4)});
}

INSTANTIATE_TEST_SUITE_P(Fidelities, StereoCoreCatchUp, testing::Values(Fidelity::kCycle, Fidelity::kFast),
                         name_of_fidelity);

// Without pixels.
class StereoCoreTiming : public StereoCoreBench {
 protected:
  Fidelity fidelity() const override { return Fidelity::kTiming; }
};

TEST_F(StereoCoreTiming, WritesNoDisparities) {
  build(small_board());
  memory.debug_write(crossbar_address(kResult, 0), Words(kImageWords, 77));
  start();
  finish();
  EXPECT_EQ(memory.debug_read(crossbar_address(kResult, 0), kImageWords), Words(kImageWords, 77));
}

TEST_F(StereoCoreTiming, TakesAsLong) {
  build(small_board());
  at(edge(3), [this] { start(); });
  finish();
  EXPECT_EQ(done_at, std::vector<sc_core::sc_time>{edge(3 + frame_cycles_alone(4))});
  EXPECT_EQ(accesses(kResult), kImageWords);
}

// A frame that is done cycle by cycle after all: in processes of their own at the two fidelities, it gives
// the same.
class WholeBoard : public StereoCoreBench {
 public:
  WholeBoard(Fidelity fidelity, bool has_direct_access)
      : fidelity_(fidelity), has_direct_access_(has_direct_access) {}
  void TestBody() override {}

  // All that is counted, and all words, after a frame on these bases and entries.
  std::string run(const std::vector<std::pair<std::uint64_t, std::uint32_t>>& bases,
                  const std::vector<std::pair<std::uint32_t, std::uint32_t>>& left_entries) {
    build(small_board());
    for (const auto& [base, value] : bases) registers.write(base, value);
    for (const auto& [place, entry] : left_entries)
      memory.debug_write(crossbar_address(kLeftTable, place), {entry});
    start();
    finish();
    return figures();
  }
  // The same of a frame that begins in the middle of a burst of 20 words, of which six have been granted; the
  // frame is to be done cycle by cycle or not.
  std::string run_within_burst(tlm::tlm_command command, std::uint32_t bank, std::uint32_t word,
                               bool stepped) {
    build(small_board());
    at(edge(0), [this, command, bank, word] {
      memory.access(command, crossbar_address(bank, word), Words(20, 0x1234'5678));
    });
    at(edge(9), [this] { start(); });
    finish();
    const bool as_expected = core->stepped_frames() == (stepped || fidelity_ == Fidelity::kCycle ? 1 : 0);
    return figures() + (as_expected ? "" : "in the other way, ") +
           testing::PrintToString(memory.answers.at(0).words);
  }

  static constexpr std::uint32_t kLeftImage = kLeft;
  static constexpr std::uint32_t kRightImage = kRight;
  static constexpr std::uint32_t kTable = kLeftTable;
  static constexpr std::uint32_t kDisparity = kResult;

 protected:
  Fidelity fidelity() const override { return fidelity_; }
  std::string figures() {
    std::string text = CoreFigures(*core).text();
    for (std::uint32_t bank = 0; bank < kBankCount; ++bank) {
      text += "accesses " + std::to_string(accesses(static_cast<Bank>(bank))) + ", words " +
              testing::PrintToString(memory.debug_read(crossbar_address(bank, 0), kWords)) + '\n';
    }
    return text;
  }

  void bind_bank(InitiatorSocket& from, TargetSocket& to, const std::string& link) override {
    if (has_direct_access_) {
      binder.bind(from, to, link);
    } else {
      DirectAccessGate& refusing = *refusing_.emplace_back(
          std::make_unique<DirectAccessGate>((link + "_without_direct_access").c_str(), false));
      from.bind(refusing.in);
      binder.bind(refusing.out, to, link);
    }
  }

 private:
  Fidelity fidelity_;
  bool has_direct_access_;
  std::vector<std::unique_ptr<DirectAccessGate>> refusing_;
};

void expect_the_same(const std::vector<std::pair<std::uint64_t, std::uint32_t>>& bases,
                     const std::vector<std::pair<std::uint32_t, std::uint32_t>>& left_entries = {},
                     bool has_direct_access = true) {
  std::vector<std::string> texts;
  for (const Fidelity fidelity : {Fidelity::kCycle, Fidelity::kFast}) {
    texts.push_back(test::run_in_child([&] {
                      return WholeBoard(fidelity, has_direct_access).run(bases, left_entries);
                    }).text);
  }
  EXPECT_THAT(texts[0], testing::StartsWith("frame_cycles: "));
  EXPECT_EQ(texts[0], texts[1]);
}

void expect_the_same_within_burst(tlm::tlm_command command, std::uint32_t bank, std::uint32_t word,
                                  bool stepped) {
  std::vector<std::string> texts;
  for (const Fidelity fidelity : {Fidelity::kCycle, Fidelity::kFast}) {
    texts.push_back(test::run_in_child([&] {
                      return WholeBoard(fidelity, true).run_within_burst(command, bank, word, stepped);
                    }).text);
  }
  EXPECT_THAT(texts[0], testing::StartsWith("frame_cycles: "));
  EXPECT_THAT(texts[0], testing::Not(testing::HasSubstr("other way")));
  EXPECT_EQ(texts[0], texts[1]);
}

TEST(StereoCoreSlowFrame, BegunWithinABurstThatWouldNoticeGivesTheSame) {
  expect_the_same_within_burst(TLM_WRITE_COMMAND, WholeBoard::kLeftImage, 0, true);
  expect_the_same_within_burst(TLM_WRITE_COMMAND, WholeBoard::kRightImage, 5, true);
  expect_the_same_within_burst(TLM_WRITE_COMMAND, WholeBoard::kTable, 41, true);
  expect_the_same_within_burst(TLM_WRITE_COMMAND, WholeBoard::kDisparity, 0, true);
  expect_the_same_within_burst(TLM_READ_COMMAND, WholeBoard::kDisparity, 0, true);
}

TEST(StereoCoreBurstBefore, IsNotNoticedWhereItHasOnlyWordsOfOthersToGo) {
  expect_the_same_within_burst(TLM_WRITE_COMMAND, WholeBoard::kLeftImage, 6, false);
  expect_the_same_within_burst(TLM_READ_COMMAND, WholeBoard::kDisparity, 6, false);
  expect_the_same_within_burst(TLM_READ_COMMAND, WholeBoard::kLeftImage, 0, false);
  expect_the_same_within_burst(TLM_READ_COMMAND, WholeBoard::kTable, 0, false);
}

TEST(StereoCoreSlowFrame, OverlappingAnImageGivesTheSame) {
  for (const std::uint32_t word : {0U, 3U, 11U}) {
    expect_the_same({{registers::kDisparityBase, registers::base(WholeBoard::kLeftImage, word)}});
    expect_the_same({{registers::kDisparityBase, registers::base(WholeBoard::kRightImage, word)}});
  }
}

TEST(StereoCoreSlowFrame, OverlappingATableGivesTheSame) {
  for (const std::uint32_t word : {0U, 20U, 47U})
    expect_the_same({{registers::kDisparityBase, registers::base(WholeBoard::kTable, word)}});
}

TEST(StereoCoreSlowFrame, WithEntriesOutsideTheImageGivesTheSame) {
  expect_the_same({}, {{5, kernels::make_entry(8, 0)}, {30, kernels::make_entry(7, 6)}});
  expect_the_same({}, {{47, kernels::make_entry(2047, 2047)}});  // behind the bank's end
}

TEST(StereoCoreSlowFrame, BehindTheEndOfABankGivesTheSame) {
  expect_the_same({{registers::kLeftImageBase, registers::base(WholeBoard::kLeftImage, 60)}});
  expect_the_same({{registers::kDisparityBase, registers::base(2, 60)}});
}

TEST(StereoCoreSlowFrame, WithoutDirectAccessGivesTheSame) { expect_the_same({}, {}, false); }

}  // namespace
}  // namespace stereotlm::fpga
