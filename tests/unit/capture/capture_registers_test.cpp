// The registers of a capture board, and what a driver sees of a capture.
#include <array>
#include <stdexcept>

#include "tests/support/expected_report.h"
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

  // Sends `payload`, which must be refused so and change nothing.
  void expect_refused(tlm::tlm_generic_payload& payload, tlm::tlm_response_status expected) {
    const auto refused = stats().refused_accesses;
    sc_core::sc_time delay;
    side->host.socket->b_transport(payload, delay);
    EXPECT_EQ(payload.get_response_status(), expected);
    EXPECT_EQ(delay, sc_core::SC_ZERO_TIME);
    EXPECT_EQ(stats().refused_accesses, refused + 1);
    EXPECT_EQ(side->status(), 0U);
    EXPECT_EQ(reg(kBufferAddress), 0U);
    side->binder.take_violations();
  }
};

TEST_F(CaptureRegisters, BeginWithZeros) {
  build();
  for (std::uint64_t address = kStatus; address < registers::kEnd; address += 4)
    EXPECT_EQ(reg(address), 0U) << address;
}

TEST_F(CaptureRegisters, KeepTheBufferAddress) {
  build();
  side->write(kBufferAddress, 0xFEDC'BA98);
  EXPECT_EQ(reg(kBufferAddress), 0xFEDC'BA98);
  EXPECT_EQ(side->host.debug_read(kBufferAddress, 1), std::vector<std::uint32_t>{0xFEDC'BA98});
}

TEST_F(CaptureRegisters, RefuseWhatTheHardwareHasNot) {
  build();
  std::array<std::uint32_t, 2> words{kControlArm, kControlArm};
  tlm::tlm_generic_payload access;
  const auto set = [&](tlm::tlm_command command, std::uint64_t address) {
    access.set_command(command);
    access.set_address(address);
    access.set_data_ptr(reinterpret_cast<unsigned char*>(words.data()));
    access.set_data_length(4);
    access.set_streaming_width(4);
    access.set_byte_enable_ptr(nullptr);
    access.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
  };
  for (const auto command : {tlm::TLM_READ_COMMAND, tlm::TLM_WRITE_COMMAND}) {
    set(command, registers::kEnd);
    expect_refused(access, tlm::TLM_ADDRESS_ERROR_RESPONSE);
    set(command, kStatus + 2);
    expect_refused(access, tlm::TLM_ADDRESS_ERROR_RESPONSE);
    set(command, kBufferAddress);
    access.set_data_length(8);
    expect_refused(access, tlm::TLM_BURST_ERROR_RESPONSE);
    set(command, kBufferAddress);
    access.set_streaming_width(2);
    expect_refused(access, tlm::TLM_BURST_ERROR_RESPONSE);
    unsigned char enable = TLM_BYTE_ENABLED;
    set(command, kBufferAddress);
    access.set_byte_enable_ptr(&enable);
    access.set_byte_enable_length(1);
    expect_refused(access, tlm::TLM_BYTE_ENABLE_ERROR_RESPONSE);
  }
  set(tlm::TLM_IGNORE_COMMAND, kBufferAddress);
  expect_refused(access, tlm::TLM_COMMAND_ERROR_RESPONSE);
  set(tlm::TLM_READ_COMMAND, kControl);
  expect_refused(access, tlm::TLM_COMMAND_ERROR_RESPONSE);
  for (std::uint64_t address = registers::kFrameNumberLow; address < registers::kEnd; address += 4) {
    set(tlm::TLM_WRITE_COMMAND, address);
    expect_refused(access, tlm::TLM_COMMAND_ERROR_RESPONSE);
  }
  EXPECT_EQ(side->host.debug_write(kBufferAddress, {4}), 0U);
  EXPECT_EQ(side->host.debug_read(kControl, 1).size(), 0U);
}

TEST_F(CaptureRegisters, ShowACaptureFromArmingToItsEnd) {
  build();
  run_to(1'000);
  side->arm(kAddress);
  EXPECT_EQ(side->status(), kStatusArmed);
  run_to(frame_ps(1));
  EXPECT_EQ(side->status(), kStatusArmed);
  run_to(frame_ps(1) + 1);
  EXPECT_EQ(side->status(), kStatusCapturing);
  run_to(frame_ps(1) + word_ps(3, 2));
  ASSERT_EQ(side->bus.requests_ps.size(), side->bus.bursts.size() + 1);
  run_to(frame_ps(1) + word_ps(3, 2) + 1'000'000);
  const std::uint64_t end_ps = side->bus.bursts.back().end_ps;
  EXPECT_EQ(side->status(), kStatusDone);
  EXPECT_TRUE(side->board.interrupt->is_asserted());
  ASSERT_TRUE(side->board.last_capture());
  EXPECT_EQ(side->board.last_capture()->frame, 1U);
  EXPECT_EQ(side->board.last_capture()->begin_ps, frame_ps(1));
  EXPECT_EQ(side->board.last_capture()->end_ps, end_ps);
  EXPECT_EQ(reg(registers::kFrameNumberLow), 1U);
  EXPECT_EQ(reg(registers::kFrameNumberHigh), 0U);
}

TEST_F(CaptureRegisters, RaiseTheInterruptWhenTheLastWordHasLeft) {
  build_and_arm();
  side->bus.turn.wait_clocks = 3;
  run_to(word_ps(3, 2));
  run_to(now_ps() + 100'000);
  const std::uint64_t end_ps = side->bus.bursts.back().end_ps;
  ASSERT_GT(end_ps, now_ps());
  run_to(end_ps - 1);
  EXPECT_FALSE(side->board.interrupt->is_asserted());
  EXPECT_EQ(side->status(), kStatusCapturing);
  run_to(end_ps);
  EXPECT_TRUE(side->board.interrupt->is_asserted());
  EXPECT_EQ(side->status(), kStatusDone);
}

TEST_F(CaptureRegisters, ClearStatusBitsThatAreWrittenOne) {
  build_and_arm();
  side->arm(kAddress);  // refused
  run_frame();
  EXPECT_EQ(side->status(), kStatusDone | kStatusArmRefused);
  side->write(kStatus, 0);
  run_to(now_ps());
  EXPECT_EQ(side->status(), kStatusDone | kStatusArmRefused);
  EXPECT_TRUE(side->board.interrupt->is_asserted());
  side->write(kStatus, kStatusDone);
  run_to(now_ps());
  EXPECT_EQ(side->status(), kStatusArmRefused);
  EXPECT_FALSE(side->board.interrupt->is_asserted());
  side->write(kStatus, kStatusArmRefused);
  EXPECT_EQ(side->status(), 0U);
}

TEST_F(CaptureRegisters, RefuseToArmTwice) {
  build_and_arm();
  side->arm(kAddress + 0x100);
  EXPECT_EQ(side->status(), kStatusArmed | kStatusArmRefused);
  run_frame();
  EXPECT_EQ(burst(0).address, kAddress);  // as it was armed
  EXPECT_EQ(stats().captured_frames, 1U);
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

TEST_F(CaptureRegisters, StartTheFrameThatBeginsWhenTheyAreArmed) {
  build();
  run_to(frame_ps(1));
  side->arm(kAddress);
  run_to(frame_ps(2) - 1);
  EXPECT_EQ(stats().captured_frames, 1U);
  EXPECT_EQ(side->board.last_capture()->frame, 1U);
}

TEST_F(CaptureRegisters, MissTheFrameThatBeganAPicosecondBefore) {
  build();
  run_to(frame_ps(1) + 1);
  side->arm(kAddress);
  run_to(frame_ps(2) - 1);
  EXPECT_EQ(stats().started_frames, 0U);
  EXPECT_EQ(stats().dropped_not_armed, 2U);
  run_to(frame_ps(3) - 1);
  EXPECT_EQ(side->board.last_capture()->frame, 2U);
}

TEST_F(CaptureRegisters, ArmAtTheTimeThatTheAccessIsAnnotatedWith) {
  build();
  run_to(frame_ps(1) - 50);
  side->arm(kAddress, Clock::to_time(50));
  run_to(frame_ps(2) - 50);
  EXPECT_EQ(side->board.last_capture()->frame, 1U);
  side->arm(kAddress, Clock::to_time(51));
  run_to(frame_ps(3) - 1);
  EXPECT_EQ(stats().started_frames, 1U);
  run_to(frame_ps(3) + 1);
  EXPECT_EQ(stats().started_frames, 2U);
  EXPECT_EQ(stats().dropped_not_armed, 2U);  // 0 and 2
}

TEST_F(CaptureRegisters, ArmTheNextCaptureWhileOneRuns) {
  build_and_arm();
  run_to(word_ps(1, 1));
  side->arm(kAddress + 0x100);
  EXPECT_EQ(side->status(), kStatusArmed | kStatusCapturing);
  run_to(frame_ps(1) - 1);
  EXPECT_EQ(side->status(), kStatusArmed | kStatusDone);
  EXPECT_EQ(side->buffer(kAddress, 0), side->source.picture(0).pixels);
  run_to(frame_ps(2) - 1);
  EXPECT_EQ(side->buffer(kAddress, 0), side->source.picture(0).pixels);
  EXPECT_EQ(side->buffer(kAddress + 0x100, 0), side->source.picture(1).pixels);
  EXPECT_EQ(stats().captured_frames, 2U);
  EXPECT_EQ(stats().dropped_frames(), 0U);
}

TEST_F(CaptureRegisters, TriggerTheCamera) {
  camera.trigger = CameraTrigger::kOnDemand;
  build();
  side->board.triggers_out.bind(side->camera.triggers_in);
  run_to(1'000);
  side->write(kBufferAddress, kAddress);
  side->write(kControl, kControlArm | kControlTrigger);
  run_to(1'001);
  EXPECT_EQ(side->status(), kStatusCapturing);
  run_to(frame_ps(2));
  ASSERT_TRUE(side->board.last_capture());
  EXPECT_EQ(side->board.last_capture()->begin_ps, 1'000U);
  EXPECT_EQ(side->buffer(kAddress, 0), side->source.picture(0).pixels);
  side->write(kControl, kControlTrigger, Clock::to_time(77));
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

TEST_F(CaptureRegisters, CountTheDroppedPixelsOfTheLastCapture) {
  build_and_arm();
  side->bus.plan = [](std::size_t request) {
    test::BusTurn turn;
    if (request == 0) turn.busy_clocks = 400'000;  // 12 ms, more than a line
    return turn;
  };
  run_frame();
  const std::uint64_t dropped = stats().dropped_pixels;
  EXPECT_GT(dropped, 0U);
  EXPECT_EQ(reg(registers::kDroppedPixels), dropped);
  EXPECT_EQ(side->board.last_capture()->dropped_pixels, dropped);
  side->write(kStatus, kStatusDone);
  side->arm(kAddress);
  run_to(frame_ps(2) - 1);
  EXPECT_EQ(reg(registers::kDroppedPixels), 0U);
  EXPECT_EQ(stats().dropped_pixels, dropped);
}

TEST_F(CaptureRegisters, DropAFrameThatBeginsWhileTheLastCaptureRuns) {
  build_and_arm();
  side->bus.plan = [this](std::size_t request) {
    test::BusTurn turn;
    // The last words leave after frame 1 has begun.
    if (request == 0) turn.busy_clocks = side->bus.clock().edge_at_or_after(frame_ps(1)) + 100;
    return turn;
  };
  run_to(frame_ps(1) - 1);
  side->arm(kAddress);
  run_to(frame_ps(1) + 1);
  EXPECT_EQ(side->status(), kStatusArmed | kStatusCapturing);
  EXPECT_EQ(stats().dropped_busy, 1U);
  EXPECT_EQ(stats().dropped_frames(), 1U);
  run_to(frame_ps(2) + 1);
  EXPECT_EQ(side->status(), kStatusDone | kStatusCapturing);  // the capture of frame 2
  EXPECT_EQ(side->board.last_capture()->frame, 0U);
}

TEST_F(CaptureRegisters, StartAFrameThatBeginsWhenTheLastCaptureEndsButNotEarlier) {
  // The only burst of frame 0 ends in the clock whose end lies at frame 1's beginning (40 ms, a whole number
  // of clocks), or in the next.
  camera = {4, 1, 25, CameraTrigger::kFreeRunning};
  clock_mhz = 40;
  build_and_arm();
  const std::uint64_t last_clock = frame_ps(1) / 25'000;
  std::uint64_t end_clock = last_clock;
  side->bus.plan = [&](std::size_t) {
    test::BusTurn turn;  // one word: address clock, data clock
    turn.busy_clocks = end_clock - 2 - side->bus.clock().edge_at_or_after(now_ps());
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
  EXPECT_EQ(stats().started_frames, 2U);
  EXPECT_EQ(stats().dropped_busy, 1U);
}

TEST_F(CaptureRegisters, ReportALineThatNoCaptureExpects) {
  build();
  const std::vector<std::uint8_t> pixels(16);
  run_to(1);
  {
    test::ExpectedReport expected("/stereotlm/capture_board");
    EXPECT_THROW(side->board.lines_in->push({0, pixels.data()}), sc_core::sc_report);
    EXPECT_EQ(expected.text(), "board: line 0 came: no capture expects it");
  }
  side->arm(kAddress);
  run_to(frame_ps(1) + 1);
  test::ExpectedReport expected("/stereotlm/capture_board");
  EXPECT_THROW(side->board.lines_in->push({2, pixels.data()}), sc_core::sc_report);
}

TEST_F(CaptureRegisters, CountEveryFrameOnce) {
  build();
  for (std::uint64_t number = 1; number < 20; ++number) {
    run_to(frame_ps(number) - 1);
    if (number % 3 == 0) side->arm(kAddress);  // for frame 3, 6, .. 18
  }
  const CaptureBoard::Stats counted = stats();
  EXPECT_EQ(counted.started_frames, 6U);
  EXPECT_EQ(counted.captured_frames, 6U);
  EXPECT_EQ(counted.started_frames + counted.dropped_frames(), side->camera.stats().frames);
}

TEST(CaptureBoard, RefusesAConfigurationWithProblems) {
  EXPECT_THROW(CaptureBoard("refused", CaptureBoardConfig{140, 141}), std::invalid_argument);
}

}  // namespace
}  // namespace stereotlm::capture
