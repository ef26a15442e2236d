// Frames that work directly on memory: which frames cannot, bursts that are a hazard, and tables that have
// changed since the last frame.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "models/testing/expected_report.h"
#include "tests/support/fork.h"
#include "tests/unit/fpga/core_figures.h"
#include "tests/unit/fpga/stereo_core_bench.h"

namespace stereotlm::fpga {
namespace {

using memory::crossbar_address;
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

  void run_frame() {
    start();
    finish();
  }
  Words result_words() { return memory.debug_read(crossbar_address(kResult, 0), kImageWords); }
  // Reports that are not thrown: the address sanitizer cannot follow an exception through SystemC's stacks.
  static void do_not_throw_reports() {
    sc_core::sc_report_handler::set_actions("/stereotlm/core", sc_core::SC_ERROR, sc_core::SC_DO_NOTHING);
  }
};

TEST_F(StereoCoreFast, TransportsOnlyTheWordsOfAFrameThatCannotWorkDirectly) {
  build(small_board());
  const auto transports = [this](std::uint32_t left_entry) {
    memory.debug_write(crossbar_address(kLeftTable, 5), {left_entry});
    const std::uint64_t before = transported(kRight);
    run_frame();
    EXPECT_EQ(status(), registers::kStatusDone);
    EXPECT_EQ(frame_cycles().back(), frame_cycles_alone(4));
    return transported(kRight) != before;
  };
  EXPECT_FALSE(transports(kernels::make_entry(5, 0)));
  EXPECT_EQ(core->stepped_frames(), 0U);
  EXPECT_TRUE(transports(kernels::make_entry(8, 0)));  // outside the image
  EXPECT_FALSE(transports(0));
  EXPECT_EQ(core->stepped_frames(), 1U);
}

TEST_F(StereoCoreFast, ReadsATableAgainThatAFrameHasOverwritten) {
  const test::ExpectedReport refusal("/stereotlm/refused_access");
  build(small_board());
  run_frame();
  // A frame on a black table leaves 0xFF everywhere; its words are entries that point outside the image.
  set_base(registers::kLeftLutBase, kSpare);
  set_base(registers::kDisparityBase, kLeftTable);
  run_frame();
  set_base(registers::kLeftLutBase, kLeftTable);
  set_base(registers::kDisparityBase, kResult);
  EXPECT_EQ(core->stepped_frames(), 0U);
  run_frame();
  EXPECT_EQ(core->stepped_frames(), 1U);
}

// A burst in cycle 10 of a frame, and what it is to the frame.
struct BurstInFrame {
  tlm::tlm_command command;
  std::uint32_t bank;
  std::uint32_t word;
  std::size_t words;
  const char* hazard;  // empty: none
};

TEST_F(StereoCoreFast, ReportsABurstThatIsAHazardAndRaisesError) {
  const BurstInFrame bursts[] = {
      {TLM_WRITE_COMMAND, kLeft, 11, 1,
       "writes words 11..11 of bank number 0, where the running frame has its left_image"},
      {TLM_WRITE_COMMAND, kRight, 3, 8,
       "writes words 3..10 of bank number 1, where the running frame has its right_image"},
      {TLM_WRITE_COMMAND, kLeftTable, 0, 1,
       "writes words 0..0 of bank number 3, where the running frame has its left_lut"},
      {TLM_WRITE_COMMAND, kRightTable, 40, 20,
       "writes words 40..59 of bank number 4, where the running frame has its right_lut"},
      {TLM_WRITE_COMMAND, kResult, 0, 1,
       "writes words 0..0 of bank number 2, where the running frame has its disparity"},
      {TLM_READ_COMMAND, kResult, 11, 2,
       "reads words 11..12 of bank number 2, where the running frame has its disparity"},
      {TLM_READ_COMMAND, kLeft, 0, 12, ""},
      {TLM_READ_COMMAND, kLeftTable, 0, 48, ""},
      {TLM_WRITE_COMMAND, kLeft, kImageWords, 4, ""},
      {TLM_WRITE_COMMAND, kLeftTable, kTableWords, 2, ""},
      {TLM_READ_COMMAND, kResult, kImageWords, 1, ""},
      {TLM_WRITE_COMMAND, kSpare, 0, 20, ""},
  };
  build(small_board());
  do_not_throw_reports();
  std::uint64_t cycle = 10'000;
  for (const BurstInFrame& burst : bursts) {
    const std::string hazard = burst.hazard;
    SCOPED_TRACE(hazard.empty() ? "bank number " + std::to_string(burst.bank) : hazard);
    at(edge(cycle), [this] { start(); });
    at(edge(cycle + 10), [this, &burst] {
      memory.access(burst.command, crossbar_address(burst.bank, burst.word), Words(burst.words));
    });
    cycle += 10'000;
    const test::ExpectedReport expected("/stereotlm/core", hazard.empty() ? 0 : 1);
    run_until(edge(cycle - 1));
    EXPECT_EQ(expected.text(),
              hazard.empty() ? "" : "core: a burst of the local bus " + hazard + ": needs fidelity cycle");
    EXPECT_EQ(status(),
              hazard.empty() ? registers::kStatusDone : registers::kStatusDone | registers::kStatusError);
    EXPECT_EQ(memory.answers.back().status, tlm::TLM_OK_RESPONSE);
  }
  EXPECT_EQ(frame_cycles().size(), std::size(bursts));
  EXPECT_EQ(core->stepped_frames(), 0U);
}

// Direct access to the disparities that ends while a frame runs.
class StereoCoreDirectAccess : public StereoCoreFast {
 protected:
  void SetUp() override { do_not_throw_reports(); }
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
  EXPECT_EQ(frame_cycles(), std::vector<std::uint64_t>{frame_cycles_alone(4)});
  EXPECT_EQ(core->frames().direct_counts().written_words, kImageWords);
  EXPECT_EQ(accesses(kResult), port(kResultGroup).granted());
  start();
  finish();
  EXPECT_EQ(status(), registers::kStatusDone);
  EXPECT_EQ(core->stepped_frames(), 1U);
}

// What is special about a frame on the small board.
struct SpecialFrame {
  const char* name;
  bool is_stepped = true;  // at fast fidelity
  std::vector<std::pair<std::uint64_t, std::uint32_t>> bases = {};
  std::vector<std::pair<std::uint32_t, std::uint32_t>> left_entries = {};
  bool has_direct_access = true;
  // A burst of 20 words; the frame begins when six of them have been granted.
  struct Burst {
    tlm::tlm_command command;
    std::uint32_t bank;
    std::uint32_t word;
  };
  std::optional<Burst> burst = std::nullopt;
};

class SpecialFrameRun : public StereoCoreBench {
 public:
  SpecialFrameRun(Fidelity fidelity, const SpecialFrame& frame) : fidelity_(fidelity), frame_(frame) {}
  void TestBody() override {}

  // All that is counted, and all words, after the frame.
  std::string text() {
    build(small_board());
    for (const auto& [base, value] : frame_.bases) registers.write(base, value);
    for (const auto& [place, entry] : frame_.left_entries)
      memory.debug_write(crossbar_address(kLeftTable, place), {entry});
    if (frame_.burst) {
      at(edge(0), [this] {
        const SpecialFrame::Burst& burst = *frame_.burst;
        memory.access(burst.command, crossbar_address(burst.bank, burst.word), Words(20, 0x1234'5678));
      });
    }
    at(edge(9), [this] { start(); });
    finish();
    EXPECT_EQ(core->stepped_frames(), frame_.is_stepped || fidelity_ == Fidelity::kCycle ? 1U : 0U);
    std::string text = CoreFigures(*core).text();
    for (std::uint32_t bank = 0; bank < kBankCount; ++bank) {
      text += "accesses " + std::to_string(accesses(bank)) + ", words " +
              testing::PrintToString(memory.debug_read(crossbar_address(bank, 0), kWords)) + '\n';
    }
    return text + (frame_.burst ? testing::PrintToString(memory.answers.at(0).words) : "");
  }

  static constexpr std::uint32_t kLeftImage = kLeft;
  static constexpr std::uint32_t kRightImage = kRight;
  static constexpr std::uint32_t kTable = kLeftTable;
  static constexpr std::uint32_t kDisparity = kResult;

 protected:
  Fidelity fidelity() const override { return fidelity_; }
  void bind_bank(InitiatorSocket& from, TargetSocket& to, const std::string& link) override {
    if (frame_.has_direct_access) {
      binder.bind(from, to, link);
      return;
    }
    DirectAccessGate& closed = *closed_.emplace_back(
        std::make_unique<DirectAccessGate>((link + "_without_direct_access").c_str(), false));
    from.bind(closed.in);
    binder.bind(closed.out, to, link);
  }

 private:
  Fidelity fidelity_;
  SpecialFrame frame_;
  std::vector<std::unique_ptr<DirectAccessGate>> closed_;
};

std::vector<SpecialFrame> special_frames() {
  using Run = SpecialFrameRun;
  return {
      {"an entry outside the image",
       true,
       {},
       {{5, kernels::make_entry(8, 0)}, {30, kernels::make_entry(7, 6)}}},
      {"an entry behind the end of the bank", true, {}, {{47, kernels::make_entry(2047, 2047)}}},
      {"an image behind the end of the bank",
       true,
       {{registers::kLeftImageBase, registers::base(Run::kLeftImage, 60)}}},
      {"disparities behind the end of the bank",
       true,
       {{registers::kDisparityBase, registers::base(Run::kDisparity, 60)}}},
      {"disparities overlap the left image",
       true,
       {{registers::kDisparityBase, registers::base(Run::kLeftImage, 3)}}},
      {"disparities overlap a table", true, {{registers::kDisparityBase, registers::base(Run::kTable, 47)}}},
      {"no direct access", true, {}, {}, false},
      {"a burst writes the left image", true, {}, {}, true, {{TLM_WRITE_COMMAND, Run::kLeftImage, 0}}},
      {"a burst writes the right image", true, {}, {}, true, {{TLM_WRITE_COMMAND, Run::kRightImage, 5}}},
      {"a burst writes a table", true, {}, {}, true, {{TLM_WRITE_COMMAND, Run::kTable, 41}}},
      {"a burst writes the disparities", true, {}, {}, true, {{TLM_WRITE_COMMAND, Run::kDisparity, 0}}},
      {"a burst reads the disparities", true, {}, {}, true, {{TLM_READ_COMMAND, Run::kDisparity, 0}}},
      {"a burst has written the left image", false, {}, {}, true, {{TLM_WRITE_COMMAND, Run::kLeftImage, 6}}},
      {"a burst has read the disparities", false, {}, {}, true, {{TLM_READ_COMMAND, Run::kDisparity, 6}}},
      {"a burst reads the left image", false, {}, {}, true, {{TLM_READ_COMMAND, Run::kLeftImage, 0}}},
      {"a burst reads a table", false, {}, {}, true, {{TLM_READ_COMMAND, Run::kTable, 0}}},
  };
}

// Each run is in a process of its own.
TEST(StereoCoreSpecialFrames, GiveTheSameAtBothFidelities) {
  sc_core::sc_report_handler::set_actions("/stereotlm/refused_access", sc_core::SC_DO_NOTHING);
  for (const SpecialFrame& frame : special_frames()) {
    std::vector<std::string> texts;
    for (const Fidelity fidelity : {Fidelity::kCycle, Fidelity::kFast})
      texts.push_back(test::run_for_text([&] { return SpecialFrameRun(fidelity, frame).text(); }));
    EXPECT_EQ(texts[0], texts[1]) << frame.name;
  }
}

}  // namespace
}  // namespace stereotlm::fpga
