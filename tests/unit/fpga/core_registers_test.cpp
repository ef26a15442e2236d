#include "models/fpga/core_registers.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

namespace stereotlm::fpga {
namespace {

namespace map = registers;

// The core takes each strobe, unless the test refuses it.
class CoreRegistersTest : public testing::Test, public CoreRegisters::Starter {
 protected:
  void start_frame(const FrameStart& start) override {
    starts.push_back(start);
    if (refuses) file.refuse_start();
  }
  void control(std::uint32_t value) { file.write(0, map::kControl, value); }
  std::uint32_t status() const { return file.read(map::kStatus); }

  CoreRegisters file{*this};
  std::vector<FrameStart> starts;
  bool refuses = false;
};

TEST_F(CoreRegistersTest, KeepBasesAndOffsets) {
  for (std::uint64_t address = map::kLeftImageBase; address < map::kEnd; address += 4) {
    EXPECT_EQ(file.read(address), 0U);
    file.write(0, address, 0xFFFF'FF00U + static_cast<std::uint32_t>(address));
  }
  for (std::uint64_t address = map::kLeftImageBase; address < map::kEnd; address += 4)
    EXPECT_EQ(file.read(address), 0xFFFF'FF00U + address);
  EXPECT_TRUE(starts.empty());
}

TEST_F(CoreRegistersTest, AllowOnlyTheDirectionsOfTheMap) {
  for (std::uint64_t address = 0; address < map::kEnd; address += 4) {
    const bool read_only =
        address == map::kStatus || address == map::kFrameCyclesLow || address == map::kFrameCyclesHigh;
    EXPECT_EQ(CoreRegisters::allows(true, address), !read_only) << address;
    EXPECT_EQ(CoreRegisters::allows(false, address), address != map::kControl) << address;
  }
}

TEST_F(CoreRegistersTest, HandTheirValuesToTheCoreWithTheStrobe) {
  std::uint32_t bank = 10;
  for (const std::uint64_t base : {map::kLeftImageBase, map::kRightImageBase, map::kDisparityBase,
                                   map::kLeftLutBase, map::kRightLutBase})
    file.write(0, base, bank++);
  std::uint32_t offset = 5;
  for (const std::uint64_t address :
       {map::kLeftColumns, map::kLeftRows, map::kRightColumns, map::kRightRows}) {
    file.write(0, address, offset);
    offset -= 4;  // two's complement
  }
  file.write(700, map::kControl, map::kControlStart);
  ASSERT_EQ(starts.size(), 1U);
  EXPECT_EQ(starts[0].time_ps, 700U);
  EXPECT_EQ(starts[0].bases, (FrameBases{13, 14, 10, 11, 12}));  // by ports
  EXPECT_EQ(starts[0].joint_offsets, (kernels::JointOffsets{{{5, 1}, {-3, -7}}}));
  EXPECT_EQ(status(), map::kStatusBusy);
}

TEST_F(CoreRegistersTest, RaiseTheInterruptWithTheEndOfAFrameUntilItIsAcknowledged) {
  control(map::kControlStart);
  EXPECT_FALSE(file.done());
  file.finish_frame(0x1'2345'6789, false);
  EXPECT_TRUE(file.done());
  EXPECT_EQ(status(), map::kStatusDone);
  control(0);
  EXPECT_TRUE(file.done());
  control(map::kControlAcknowledge);
  EXPECT_FALSE(file.done());
  EXPECT_EQ(status(), 0U);
  EXPECT_EQ(file.read(map::kFrameCyclesLow), 0x2345'6789U);
  EXPECT_EQ(file.read(map::kFrameCyclesHigh), 1U);
}

TEST_F(CoreRegistersTest, IgnoreAStrobeWhileBusyAndRaiseErrorUntilItIsAcknowledged) {
  control(map::kControlStart);
  control(map::kControlStart);
  EXPECT_EQ(starts.size(), 1U);
  EXPECT_EQ(status(), map::kStatusBusy | map::kStatusError);
  file.finish_frame(5, false);
  EXPECT_EQ(status(), map::kStatusDone | map::kStatusError);
  control(map::kControlAcknowledge);
  EXPECT_EQ(status(), 0U);
  control(map::kControlStart);
  EXPECT_EQ(starts.size(), 2U);
}

TEST_F(CoreRegistersTest, RaiseErrorWithARefusedStrobeAndAreNotBusy) {
  refuses = true;
  control(map::kControlStart);
  EXPECT_EQ(status(), map::kStatusError);
  refuses = false;
  control(map::kControlStart);
  EXPECT_EQ(status(), map::kStatusBusy | map::kStatusError);
}

TEST_F(CoreRegistersTest, RaiseErrorWithTheEndOfAFrameThatFailed) {
  control(map::kControlStart);
  file.finish_frame(5, true);
  EXPECT_EQ(status(), map::kStatusDone | map::kStatusError);
  control(map::kControlAcknowledge | map::kControlStart);  // both in one write
  EXPECT_EQ(status(), map::kStatusBusy);
  EXPECT_FALSE(file.done());
  EXPECT_EQ(starts.size(), 2U);
  file.finish_frame(5, false);
  EXPECT_EQ(status(), map::kStatusDone);
}

}  // namespace
}  // namespace stereotlm::fpga
