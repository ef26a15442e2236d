#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <optional>
#include <systemc>
#include <vector>

#include "models/capture/camera.h"
#include "models/capture/capture_board.h"
#include "models/clock.h"
#include "models/kernel_time.h"
#include "models/testing/monitoring_binder.h"
#include "models/testing/test_host.h"
#include "tests/unit/capture/test_bus.h"

namespace stereotlm::capture {

constexpr std::uint32_t kAddress = 0x1000;  // of the buffer

// A picture of noise for each frame.
class NoiseSource : public CameraSource {
 public:
  NoiseSource(int width, int height) : image_(width, height) {}
  const kernels::GrayImage& frame(std::uint64_t number, std::uint64_t begin_ps) override {
    asked.push_back(number);
    begins_ps.push_back(begin_ps);
    image_ = picture(number);
    return image_;
  }
  kernels::GrayImage picture(std::uint64_t number) const {
    kernels::GrayImage image(image_.width, image_.height);
    auto random = static_cast<std::uint32_t>(number * 7919 + 1);
    for (std::uint8_t& pixel : image.pixels) {
      random = random * 1664525U + 1013904223U;
      pixel = static_cast<std::uint8_t>(random >> 24U);
    }
    return image;
  }
  std::vector<std::uint64_t> asked;
  std::vector<std::uint64_t> begins_ps;

 private:
  kernels::GrayImage image_;
};

// Camera, board and bus of one side, and a host that accesses the registers.
struct CaptureSide {
  CaptureSide(const std::string& prefix, const CameraConfig& camera_config,
              const CaptureBoardConfig& board_config, double clock_mhz)
      : host((prefix + "host").c_str()),
        source(camera_config.width, camera_config.height),
        camera((prefix + "camera").c_str(), camera_config, source),
        board((prefix + "board").c_str(), board_config),
        bus((prefix + "bus").c_str(), clock_mhz) {
    binder.bind(host.socket, board.registers, prefix + "host_to_registers");
    board.pci.bind(bus.slot);
    camera.frames_out.bind(board.frames_in);
    board.camera.bind(camera.link);
  }

  std::uint32_t status() { return host.read(registers::kStatus).word; }
  void write(std::uint64_t address, std::uint32_t value, const sc_core::sc_time& delay = {}) {
    EXPECT_EQ(host.write(address, value, delay).status, tlm::TLM_OK_RESPONSE);
  }
  void arm(std::uint32_t address, const sc_core::sc_time& delay = {}) {
    write(registers::kBufferAddress, address);
    write(registers::kControl, registers::kControlArm, delay);
  }

  // The picture that the bus has written at `address`; `fill` where it has written nothing.
  std::vector<std::uint8_t> buffer(std::uint64_t address, std::uint8_t fill) const {
    std::vector<std::uint8_t> pixels(source.picture(0).pixels.size(), fill);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const auto word = bus.memory.find(address + i / 4 * 4);
      if (word != bus.memory.end()) pixels[i] = static_cast<std::uint8_t>(word->second >> (8 * (i % 4)));
    }
    return pixels;
  }

  test::MonitoringBinder binder;
  test::TestHost host;
  NoiseSource source;
  Camera camera;
  CaptureBoard board;
  test::TestBus bus;
};

// Runs up to a time, including everything that happens at that time.
inline void run_to(std::uint64_t time_ps) {
  if (!sc_core::sc_start_of_simulation_invoked()) sc_core::sc_start(sc_core::SC_ZERO_TIME);
  if (time_ps > kernel_time::now_ps())
    sc_core::sc_start(kernel_time::to_time(time_ps - kernel_time::now_ps()));
  while (sc_core::sc_pending_activity_at_current_time()) sc_core::sc_start(sc_core::SC_ZERO_TIME);
}

// One camera with its capture board, without the partner board. The pictures are small: 16 x 3 pixels. The
// FIFO holds 4 words and requests the bus when 2 are complete.
class CaptureBench : public testing::Test {
 protected:
  void build() { side.emplace("", camera, board, clock_mhz); }
  // Arms at time 0, in time for frame 0.
  void build_and_arm() {
    build();
    side->arm(kAddress);
  }
  std::uint64_t pixel_ps(int column, int row) const { return side->camera.timing().pixel_ps(column, row); }
  // The arrival of the last pixel of a word.
  std::uint64_t word_ps(int word, int row) const { return pixel_ps(4 * word + 3, row); }
  // Runs to the end of frame 0.
  void run_frame() { run_to(side->camera.timing().frame_ps(1) - 1); }
  // One request of the bus gets this turn, the others are granted at once.
  void plan(std::size_t request, const test::BusTurn& turn) {
    side->bus.plan = [=](std::size_t number) { return number == request ? turn : test::BusTurn{}; };
  }
  std::uint64_t edge_at_or_after(std::uint64_t time_ps) const {
    return side->bus.clock().edge_at_or_after(time_ps);
  }
  const test::TestBus::Burst& burst(std::size_t index) const { return side->bus.bursts.at(index); }

  CameraConfig camera{16, 3, 29.97, CameraTrigger::kFreeRunning};
  CaptureBoardConfig board{4, 2};
  double clock_mhz = 33.333;
  std::optional<CaptureSide> side;
};

}  // namespace stereotlm::capture
