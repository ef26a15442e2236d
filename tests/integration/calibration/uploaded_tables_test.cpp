// What lies in the banks of the tables after the driver has uploaded them, as a program on the host reads it
// back over PCI.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "calib/rig.h"
#include "calib/synthetic_rig.h"
#include "calib/tables.h"
#include "models/kernels/joint_table.h"
#include "models/kernels/stereo.h"
#include "models/pci/bridge_registers.h"
#include "platform/computer.h"
#include "platform/config/board_yaml.h"
#include "platform/config/buffer_layout.h"
#include "sw/driver/stereo_driver.h"
#include "tests/support/monitoring_binder.h"

namespace stereotlm {
namespace {

constexpr int kWidth = 64;
constexpr int kHeight = 48;

class Pictures : public capture::CameraSource {
 public:
  explicit Pictures(kernels::GrayImage picture) : picture_(std::move(picture)) {}
  const kernels::GrayImage& frame(std::uint64_t /*number*/, std::uint64_t /*begin_ps*/) override {
    return picture_;
  }

 private:
  kernels::GrayImage picture_;
};

class Deliveries : public driver::FrameListener {
 public:
  void frame_delivered(const driver::DeliveredFrame& frame) override {
    disparity.assign(frame.disparity, frame.disparity + kWidth * kHeight);
  }
  std::vector<std::uint8_t> disparity;
};

// The driver, and then reads of both tables through the bridge's window.
class DriverAndReadBack : public host::Program {
 public:
  DriverAndReadBack(driver::StereoDriver& driver, const fpga::BufferBases& buffers)
      : driver_(driver), buffers_(buffers) {}

  void run(host::HostBus& bus) override {
    driver_.run(bus);
    left = read(bus, *buffers_.left_lut);
    if (buffers_.right_lut) right = read(bus, *buffers_.right_lut);
    for (std::uint64_t address = fpga::registers::kLeftColumns; address <= fpga::registers::kRightRows;
         address += 4)
      offsets.push_back(
          static_cast<int>(bus.read(devices_.bridge_slave + pci::bridge::kCoreRegisters + address)));
  }

  std::vector<std::uint32_t> left;
  std::vector<std::uint32_t> right;
  std::vector<int> offsets;  // of joint tables

 private:
  std::vector<std::uint32_t> read(host::HostBus& bus, std::uint32_t buffer) const {
    constexpr std::uint64_t kAperture = 3;
    bus.write(devices_.bridge_registers + pci::bridge::kPage + 4 * kAperture, buffer);
    std::vector<std::uint32_t> words;
    for (std::uint64_t word = 0; word < kWidth * kHeight; ++word) {
      words.push_back(bus.read(devices_.bridge_slave + kAperture * pci::bridge::kApertureBytes + 4 * word));
    }
    return words;
  }

  driver::StereoDriver& driver_;
  fpga::BufferBases buffers_;
  platform::DeviceMap devices_;
};

class UploadedTables : public testing::TestWithParam<bool> {};

INSTANTIATE_TEST_SUITE_P(Uploaded, UploadedTables, testing::Bool(),
                         [](const auto& suite) { return suite.param ? "Joint" : "Separate"; });

TEST_P(UploadedTables, AreWhatTheirBanksHold) {
  const calib::SyntheticRig rig(1, kWidth, kHeight);
  const calib::TablePair tables = calib::tables(rig.rig(), calib::rectify(rig.rig()), 5);
  const auto invalid = [](const kernels::RectificationTable& table) {
    return std::count(table.entries.begin(), table.entries.end(), 0U);
  };
  ASSERT_GT(invalid(tables.left), 0);

  std::vector<std::string> sets = {"image.width=64", "image.height=48", "matcher.disparities=16",
                                   "cameras.frame_rate_hz=1000"};
  if (GetParam()) {
    for (const char* set : {"fpga.tables=joint", "allocation.right_lut=bank6", "fpga.pixel_cache=word"})
      sets.emplace_back(set);
  }
  const platform::BoardConfig board = platform::load_board("fpl2003", sets);
  const auto scene = rig.scene();
  Pictures left(scene.left);
  Pictures right(scene.right);
  Deliveries deliveries;
  const driver::DriverConfig config = driver::driver_config(board, 2);
  driver::StereoDriver driver(config, &tables.left.entries, &tables.right.entries, deliveries);
  DriverAndReadBack program(driver, platform::buffer_bases(board));
  test::MonitoringBinder binder;
  platform::Computer computer("computer", board, driver::host_memory_bytes(config), program, left, right,
                              binder);
  for (int ms = 0; ms < 100 && !computer.cpu.finished(); ++ms) sc_core::sc_start(1, sc_core::SC_MS);
  ASSERT_TRUE(computer.cpu.finished());
  if (GetParam()) {
    const std::vector<int>& read = program.offsets;
    const kernels::JointOffsets offsets = {{{read.at(0), read.at(1)}, {read.at(2), read.at(3)}}};
    EXPECT_NE(offsets, kernels::JointOffsets());
    for (std::size_t pixel = 0; pixel < program.left.size(); ++pixel) {
      const int column = static_cast<int>(pixel) % kWidth;
      const int row = static_cast<int>(pixel) / kWidth;
      const std::uint32_t word = program.left[pixel];
      ASSERT_EQ(kernels::left_entry(word, column, row, offsets), tables.left.entries[pixel]) << pixel;
      ASSERT_EQ(kernels::right_entry(word, column, row, offsets), tables.right.entries[pixel]) << pixel;
    }
  } else {
    EXPECT_EQ(program.left, tables.left.entries);
    EXPECT_EQ(program.right, tables.right.entries);
  }
  const platform::MatcherConfig& matcher = board.matcher;
  EXPECT_EQ(
      deliveries.disparity,
      kernels::disparity_image(scene.left, scene.right, &tables.left, &tables.right,
                               {matcher.window, matcher.disparities, matcher.filter, matcher.lr_tolerance})
          .pixels);
}

}  // namespace
}  // namespace stereotlm
