#include "models/fpga/register_file.h"

#include <gtest/gtest.h>

#include <array>

#include "tests/support/monitoring_binder.h"
#include "tests/support/test_host.h"
#include "tests/unit/fpga/stream_ends.h"

namespace stereotlm::fpga {
namespace {

using registers::kControl;
using registers::kControlAcknowledge;
using registers::kControlStart;
using registers::kStatus;
using registers::kStatusBusy;
using registers::kStatusDone;
using registers::kStatusError;
using test::TestHost;

const std::vector<std::uint64_t> kBases = {registers::kLeftImageBase, registers::kRightImageBase,
                                           registers::kDisparityBase, registers::kLeftLutBase,
                                           registers::kRightLutBase};
const std::vector<std::uint64_t> kOffsets = {registers::kLeftColumns, registers::kLeftRows,
                                             registers::kRightColumns, registers::kRightRows};

class RegisterFileTest : public testing::Test {
 protected:
  RegisterFileTest() {
    binder.bind(host.socket, file.registers, "host_to_registers");
    file.done(done);
    file.start_out.bind(starts);
    settle();
  }
  static void settle() { sc_core::sc_start(sc_core::sc_time(1, sc_core::SC_NS)); }

  void control(std::uint32_t value) {
    ASSERT_EQ(host.write(kControl, value).status, tlm::TLM_OK_RESPONSE);
    settle();
  }
  void finish_frame(std::uint64_t frame_cycles, bool access_error = false) {
    file.finish_frame(frame_cycles, access_error);
    settle();
  }
  std::uint32_t status() { return host.read(kStatus).word; }

  test::MonitoringBinder binder;
  TestHost host{"test_host"};
  RegisterFile file{"file"};
  sc_core::sc_signal<bool> done{"done"};
  Collected<FrameStart> starts;
};

TEST_F(RegisterFileTest, KeepsTheBaseRegisters) {
  for (std::uint32_t i = 0; i < kBases.size(); ++i) {
    EXPECT_EQ(host.read(kBases[i]).word, 0U);
    EXPECT_EQ(host.write(kBases[i], registers::base(i, 100 + i)).status, tlm::TLM_OK_RESPONSE);
  }
  for (std::uint32_t i = 0; i < kBases.size(); ++i)
    EXPECT_EQ(host.read(kBases[i]).word, registers::base(i, 100 + i));
  EXPECT_EQ(file.stats().reads, 10U);
  EXPECT_EQ(file.stats().writes, 5U);
}

TEST_F(RegisterFileTest, HandsTheBasesToTheCoreWithTheStrobe) {
  for (std::uint32_t i = 0; i < kBases.size(); ++i) host.write(kBases[i], 10 + i);
  EXPECT_TRUE(starts.beats.empty());
  control(kControlStart);
  ASSERT_EQ(starts.beats.size(), 1U);
  EXPECT_EQ(starts.beats[0].bases, (FrameBases{13, 14, 10, 11, 12}));  // by ports
  EXPECT_EQ(status(), kStatusBusy);
}

TEST_F(RegisterFileTest, HandsTheOffsetsOfJointTablesToTheCoreWithTheStrobe) {
  EXPECT_EQ(kOffsets, (std::vector<std::uint64_t>{0x24, 0x28, 0x2c, 0x30}));
  for (std::uint32_t i = 0; i < kOffsets.size(); ++i) {
    host.write(kOffsets[i], 5 - 4 * i);  // two's complement
    EXPECT_EQ(host.read(kOffsets[i]).word, 5 - 4 * i);
  }
  control(kControlStart);
  EXPECT_EQ(starts.beats[0].joint_offsets, (kernels::JointOffsets{{{5, 1}, {-3, -7}}}));
  EXPECT_EQ(starts.beats[0].bases, FrameBases{});
}

TEST_F(RegisterFileTest, RaisesTheInterruptWithTheEndOfAFrameUntilItIsAcknowledged) {
  control(kControlStart);
  EXPECT_FALSE(done.read());
  finish_frame(0x1'2345'6789);
  EXPECT_TRUE(done.read());
  EXPECT_EQ(status(), kStatusDone);
  EXPECT_EQ(host.read(registers::kFrameCyclesLow).word, 0x2345'6789U);
  EXPECT_EQ(host.read(registers::kFrameCyclesHigh).word, 1U);
  control(0);
  EXPECT_TRUE(done.read());
  control(kControlAcknowledge);
  EXPECT_FALSE(done.read());
  EXPECT_EQ(status(), 0U);
  EXPECT_EQ(host.read(registers::kFrameCyclesLow).word, 0x2345'6789U);
}

TEST_F(RegisterFileTest, IgnoresAStrobeWhileBusyAndRaisesError) {
  control(kControlStart);
  control(kControlStart);
  EXPECT_EQ(starts.beats.size(), 1U);
  EXPECT_EQ(status(), kStatusBusy | kStatusError);
  finish_frame(5);
  EXPECT_EQ(status(), kStatusDone | kStatusError);  // stays
  control(kControlAcknowledge);
  EXPECT_EQ(status(), 0U);
  control(kControlStart);
  EXPECT_EQ(starts.beats.size(), 2U);
}

TEST_F(RegisterFileTest, RaisesErrorWithARefusedStrobeAndIsNotBusy) {
  control(kControlStart);
  file.refuse_start();
  settle();
  EXPECT_EQ(status(), kStatusError);
  EXPECT_FALSE(done.read());
}

TEST_F(RegisterFileTest, RaisesErrorWithTheEndOfAFrameThatMemoryRefused) {
  control(kControlStart);
  finish_frame(5, true);
  EXPECT_EQ(status(), kStatusDone | kStatusError);
  control(kControlAcknowledge | kControlStart);  // both in one write
  EXPECT_EQ(status(), kStatusBusy);
  EXPECT_FALSE(done.read());
  EXPECT_EQ(starts.beats.size(), 2U);
  finish_frame(5);
  EXPECT_EQ(status(), kStatusDone);
}

TEST_F(RegisterFileTest, RefusesTheDirectionThatARegisterDoesNotHave) {
  EXPECT_EQ(host.read(kControl).status, tlm::TLM_COMMAND_ERROR_RESPONSE);
  for (const std::uint64_t address : {kStatus, registers::kFrameCyclesLow, registers::kFrameCyclesHigh}) {
    EXPECT_EQ(host.write(address, 1).status, tlm::TLM_COMMAND_ERROR_RESPONSE) << address;
    EXPECT_EQ(host.read(address).status, tlm::TLM_OK_RESPONSE) << address;
  }
  EXPECT_EQ(file.stats().errors, 4U);
}

TEST_F(RegisterFileTest, RefusesAccessesThatAreNotOneWordOfARegister) {
  struct Access {
    std::uint64_t address = registers::kLeftImageBase;
    unsigned length = 4;
    unsigned streaming_width = 8;
    bool has_enables = false;
    tlm::tlm_command command = tlm::TLM_WRITE_COMMAND;
    tlm::tlm_response_status response = tlm::TLM_BURST_ERROR_RESPONSE;
  };
  std::vector<Access> accesses(7);
  accesses[0].length = 1;
  accesses[1].length = 3;
  accesses[2].length = 8;
  accesses[3].streaming_width = 3;
  accesses[4].has_enables = true;
  accesses[4].response = tlm::TLM_BYTE_ENABLE_ERROR_RESPONSE;
  accesses[5].address += 2;
  accesses[5].response = tlm::TLM_ADDRESS_ERROR_RESPONSE;
  accesses[6].command = tlm::TLM_IGNORE_COMMAND;
  accesses[6].response = tlm::TLM_COMMAND_ERROR_RESPONSE;
  std::array<unsigned char, 8> data;
  data.fill(0xFF);
  for (const Access& access : accesses) {
    tlm::tlm_generic_payload payload;
    payload.set_command(access.command);
    payload.set_address(access.address);
    payload.set_data_ptr(data.data());
    payload.set_data_length(access.length);
    payload.set_streaming_width(access.streaming_width);
    if (access.has_enables) payload.set_byte_enable_ptr(data.data());
    payload.set_byte_enable_length(access.has_enables ? 4 : 0);
    sc_core::sc_time delay;
    host.socket->b_transport(payload, delay);
    EXPECT_EQ(payload.get_response_status(), access.response);
    EXPECT_EQ(delay, sc_core::SC_ZERO_TIME);
  }
  EXPECT_EQ(file.stats().errors, accesses.size());
  EXPECT_TRUE(starts.beats.empty());
  for (const std::uint64_t base : kBases) EXPECT_EQ(host.read(base).word, 0U);
  binder.take_violations();
  EXPECT_EQ(host.write(registers::kEnd - 4, 0).status, tlm::TLM_OK_RESPONSE);
  EXPECT_EQ(host.write(registers::kEnd, 0).status, tlm::TLM_ADDRESS_ERROR_RESPONSE);
  EXPECT_EQ(host.read(registers::kEnd).status, tlm::TLM_ADDRESS_ERROR_RESPONSE);
}

TEST_F(RegisterFileTest, LetsDebugTransportReadAndNotWrite) {
  host.write(registers::kDisparityBase, 42);
  EXPECT_EQ(host.debug_read(registers::kDisparityBase, 1), (std::vector<std::uint32_t>{42}));
  EXPECT_TRUE(host.debug_read(kControl, 1).empty());
  EXPECT_TRUE(host.debug_read(registers::kEnd, 1).empty());
  EXPECT_EQ(host.debug_write(registers::kDisparityBase, {43}), 0U);
  EXPECT_EQ(host.read(registers::kDisparityBase).word, 42U);
}

TEST(RegisterMap, PlacesABaseInTheAddressesOfTheCrossbar) {
  EXPECT_EQ(registers::base_address(registers::base(0, 0)), 0U);
  EXPECT_EQ(registers::base_address(registers::base(1, 5)), (std::uint64_t{1} << 28U) + 20);
  EXPECT_EQ(registers::base_address(registers::base(63, (1U << 26U) - 1)), (std::uint64_t{1} << 34U) - 4);
}

}  // namespace
}  // namespace stereotlm::fpga
