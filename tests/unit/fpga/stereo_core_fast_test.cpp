// Frames that work directly on memory: bursts that are a hazard, and memory that takes its access back.
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "models/testing/access_probe.h"
#include "models/testing/expected_report.h"
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
class DirectAccessGate : public test::AccessProbe {
 public:
  using AccessProbe::AccessProbe;
  void close() {
    is_open_ = false;
    invalidate_direct_mem_ptr(0, UINT64_MAX);
  }

 private:
  bool get_direct_mem_ptr(tlm::tlm_generic_payload& access, tlm::tlm_dmi& dmi) override {
    if (is_open_) return AccessProbe::get_direct_mem_ptr(access, dmi);
    dmi.init();
    return false;
  }

  bool is_open_ = true;
};

class StereoCoreFast : public StereoCoreBench {
 protected:
  Fidelity fidelity() const override { return Fidelity::kFast; }

  Words result_words() { return memory.debug_read(crossbar_address(kResult, 0), kImageWords); }
  // Reports that are not thrown: the address sanitizer cannot follow an exception through SystemC's stacks.
  static void do_not_throw_reports() {
    sc_core::sc_report_handler::set_actions("/stereotlm/core", sc_core::SC_ERROR, sc_core::SC_DO_NOTHING);
  }
};

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
    from.bind(gates_.back()->from_initiator);
    binder.bind(gates_.back()->to_target, to, link);
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

}  // namespace
}  // namespace stereotlm::fpga
