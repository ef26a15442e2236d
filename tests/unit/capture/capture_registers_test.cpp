// The registers of a capture board, and a capture as a driver sees it.
#include <ostream>
#include <stdexcept>

#include "models/capture/capture_fifo.h"
#include "models/testing/expected_report.h"
#include "tests/support/refused_access.h"
#include "tests/unit/capture/capture_bench.h"

namespace stereotlm::capture {
namespace {

using registers::kBufferAddress;
using registers::kControl;
using registers::kControlArm;
using registers::kControlTrigger;
using registers::kStatus;
using registers::kStatusArmed;
using registers::kStatusArmRefused;
using registers::kStatusCapturing;
using registers::kStatusDone;
using registers::kStatusWordsLost;

class CaptureRegisters : public CaptureBench {
 protected:
  std::uint32_t reg(std::uint64_t address) { return side->host.read(address).word; }
  std::uint64_t frame_ps(std::uint64_t number) const { return side->camera.timing().frame_ps(number); }
  CaptureBoard::Stats stats() const { return side->board.stats(); }
};

TEST_F(CaptureRegisters, AreZeroAtFirstAndKeepTheBufferAddress) {
  build();
  for (std::uint64_t address = kStatus; address < registers::kEnd; address += 4)
    EXPECT_EQ(reg(address), 0U) << address;
  side->write(kBufferAddress, 0xFEDC'BA98);
  EXPECT_EQ(reg(kBufferAddress), 0xFEDC'BA98);
}

TEST_F(CaptureRegisters, RefuseIncorrectAccessesWithoutEffect) {
  const test::ExpectedReport refusal("/stereotlm/refused_access");
  build();
  std::vector<test::RefusedAccess> refused;
  for (const auto command : {tlm::TLM_READ_COMMAND, tlm::TLM_WRITE_COMMAND}) {
    refused.push_back({tlm::TLM_ADDRESS_ERROR_RESPONSE, command, registers::kEnd});
    refused.push_back({tlm::TLM_ADDRESS_ERROR_RESPONSE, command, kStatus + 2});
    refused.push_back({tlm::TLM_BURST_ERROR_RESPONSE, command, kBufferAddress, 8, 8});
    refused.push_back({tlm::TLM_BURST_ERROR_RESPONSE, command, kBufferAddress, 4, 2});
    refused.push_back({tlm::TLM_BYTE_ENABLE_ERROR_RESPONSE, command, kBufferAddress, 4, 4, 1});
  }
  refused.push_back({tlm::TLM_COMMAND_ERROR_RESPONSE, tlm::TLM_IGNORE_COMMAND, kBufferAddress});
  refused.push_back({tlm::TLM_COMMAND_ERROR_RESPONSE, tlm::TLM_READ_COMMAND, kControl});
  for (std::uint64_t address = registers::kFrameNumberLow; address < registers::kEnd; address += 4)
    refused.push_back({tlm::TLM_COMMAND_ERROR_RESPONSE, tlm::TLM_WRITE_COMMAND, address});
  for (const test::RefusedAccess& access : refused) test::expect_refused(side->host.socket, access);
  side->binder.take_violations();
  EXPECT_EQ(stats().refused_accesses, refused.size());
  EXPECT_EQ(side->status(), 0U);
  EXPECT_EQ(reg(kBufferAddress), 0U);
}

// The interrupt is raised when the last word has left.
TEST_F(CaptureRegisters, ShowACaptureFromArmingToItsEnd) {
  build();
  side->bus.turn.wait_clocks = 3;
  run_to(1'000);
  side->arm(kAddress);
  run_to(frame_ps(1));
  EXPECT_EQ(side->status(), kStatusArmed);
  run_to(frame_ps(1) + 1);
  EXPECT_EQ(side->status(), kStatusCapturing);
  run_to(frame_ps(1) + word_ps(3, 2) + 100'000);
  const std::uint64_t end_ps = side->bus.bursts.back().end_ps;
  ASSERT_GT(end_ps, kernel_time::now_ps());
  run_to(end_ps - 1);
  EXPECT_FALSE(side->board.interrupt->is_asserted());
  EXPECT_EQ(side->status(), kStatusCapturing);
  run_to(end_ps);
  EXPECT_TRUE(side->board.interrupt->is_asserted());
  EXPECT_EQ(side->status(), kStatusDone);
  ASSERT_TRUE(side->board.last_capture());
  EXPECT_EQ(side->board.last_capture()->frame, 1U);
  EXPECT_EQ(side->board.last_capture()->begin_ps, frame_ps(1));
  EXPECT_EQ(side->board.last_capture()->end_ps, end_ps);
  EXPECT_EQ(reg(registers::kFrameNumberLow), 1U);
  EXPECT_EQ(reg(registers::kFrameNumberHigh), 0U);
}

TEST_F(CaptureRegisters, RefuseToArmTwiceAndClearStatusBitsThatAreWrittenOne) {
  build_and_arm();
  side->arm(kAddress + 0x100);
  EXPECT_EQ(side->status(), kStatusArmed | kStatusArmRefused);
  run_frame();
  EXPECT_EQ(burst(0).address, kAddress);  // as it was armed
  EXPECT_EQ(side->status(), kStatusDone | kStatusArmRefused);
  struct Write {
    std::uint32_t value;
    std::uint32_t status;
    bool interrupt;
  };
  for (const Write& write :
       {Write{0, kStatusDone | kStatusArmRefused, true}, Write{kStatusDone, kStatusArmRefused, false},
        Write{kStatusArmRefused, 0, false}}) {
    side->write(kStatus, write.value);
    EXPECT_EQ(side->status(), write.status);
    EXPECT_EQ(side->board.interrupt->is_asserted(), write.interrupt);
  }
}

TEST_F(CaptureRegisters, RefuseToArmAtAnAddressInsideAWord) {
  build();
  for (const std::uint32_t address : {1U, 2U, 3U}) {
    side->arm(kAddress + address);
    EXPECT_EQ(side->status(), kStatusArmRefused) << address;
    side->write(kStatus, kStatusArmRefused);
  }
  side->arm(kAddress + 4);
  EXPECT_EQ(side->status(), kStatusArmed);
}

// A write that arms, from the beginning of frame 1 on, and the delay of its access.
struct Arming {
  const char* name;
  int write_ps;
  std::uint64_t delay_ps;
  std::uint64_t frame;  // expected number of the captured frame
};
void PrintTo(const Arming& arming, std::ostream* out) { *out << arming.name; }

class CaptureArming : public CaptureRegisters, public testing::WithParamInterface<Arming> {};

TEST_P(CaptureArming, TakesTheFirstFrameThatBeginsAtOrAfterTheTimeOfItsAccess) {
  build();
  run_to(frame_ps(1) + static_cast<std::uint64_t>(GetParam().write_ps));
  side->arm(kAddress, kernel_time::to_time(GetParam().delay_ps));
  run_to(frame_ps(3) - 1);
  ASSERT_TRUE(side->board.last_capture());
  EXPECT_EQ(side->board.last_capture()->frame, GetParam().frame);
  EXPECT_EQ(stats().started_frames, 1U);
  EXPECT_EQ(stats().dropped_not_armed, 2U);
}

INSTANTIATE_TEST_SUITE_P(Times, CaptureArming,
                         testing::Values(Arming{"at_the_beginning", 0, 0, 1}, Arming{"a_ps_later", 1, 0, 2},
                                         Arming{"delayed_to_the_beginning", -50, 50, 1},
                                         Arming{"delayed_to_a_ps_later", -50, 51, 2}),
                         [](const auto& tested) { return tested.param.name; });

TEST_F(CaptureRegisters, TriggerTheCamera) {
  camera.trigger = CameraTrigger::kOnDemand;
  build();
  side->board.triggered.bind(side->camera.link);
  run_to(1'000);
  side->write(kBufferAddress, kAddress);
  side->write(kControl, kControlArm | kControlTrigger);
  run_to(1'001);
  EXPECT_EQ(side->status(), kStatusCapturing);
  run_to(frame_ps(2));
  ASSERT_TRUE(side->board.last_capture());
  EXPECT_EQ(side->board.last_capture()->begin_ps, 1'000U);
  EXPECT_EQ(side->buffer(kAddress, 0), side->source.picture(0).pixels);
  side->write(kControl, kControlTrigger, kernel_time::to_time(77));
  run_to(frame_ps(2) + 77);
  EXPECT_EQ(side->camera.stats().frames, 2U);
  run_to(frame_ps(2) + 78);
  EXPECT_EQ(stats().dropped_not_armed, 1U);
}

TEST_F(CaptureRegisters, TriggerNothingWithoutCameraOnDemand) {
  build();
  side->write(kControl, kControlTrigger);
  run_frame();
  EXPECT_EQ(side->camera.stats().frames, 1U);
  EXPECT_EQ(side->camera.stats().ignored_triggers, 0U);
}

TEST_F(CaptureRegisters, StartAFrameThatBeginsWhenTheLastCaptureEndsButNotEarlier) {
  // A frame lasts 40 ms, a whole number of clocks, and has one burst. The burst of frame 0 ends when frame 1
  // begins. The burst of frame 1 ends one clock after frame 2 begins.
  camera = {4, 1, 25, CameraTrigger::kFreeRunning};
  clock_mhz = 40;
  build_and_arm();
  const std::uint64_t last_clock = frame_ps(1) / 25'000;
  std::uint64_t end_clock = last_clock;
  side->bus.plan = [&](std::size_t) {
    test::BusTurn turn;  // one word: address clock, data clock
    turn.busy_clocks = end_clock - 2 - edge_at_or_after(kernel_time::now_ps());
    return turn;
  };
  run_to(1'000'000);
  side->arm(kAddress);
  run_to(frame_ps(1) + 1);
  EXPECT_EQ(burst(0).end_ps, frame_ps(1));
  EXPECT_EQ(stats().started_frames, 2U);
  EXPECT_EQ(stats().dropped_busy, 0U);
  side->arm(kAddress);
  end_clock = 2 * last_clock + 1;
  run_to(frame_ps(2) + 1);
  EXPECT_EQ(side->status(), kStatusArmed | kStatusCapturing | kStatusDone);
  EXPECT_EQ(stats().started_frames, 2U);
  EXPECT_EQ(stats().dropped_busy, 1U);
  EXPECT_EQ(stats().dropped_frames(), 1U);
  run_to(frame_ps(3) + 1);
  EXPECT_EQ(side->board.last_capture()->frame, 1U);
  EXPECT_EQ(stats().started_frames, 3U);
}

TEST(CaptureBoard, RefusesAConfigurationWithProblems) {
  EXPECT_THROW(CaptureBoard("refused", CaptureBoardConfig{140, 141}), std::invalid_argument);
  EXPECT_THROW(CaptureFifo(CaptureBoardConfig{4, 5}), std::invalid_argument);
}

}  // namespace
}  // namespace stereotlm::capture
