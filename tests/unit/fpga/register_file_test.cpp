#include "models/fpga/register_file.h"

#include <gtest/gtest.h>

#include <array>

#include "models/testing/expected_report.h"
#include "models/testing/monitoring_binder.h"
#include "models/testing/test_host.h"
#include "tests/unit/fpga/stream_ends.h"

namespace stereotlm::fpga {
namespace {

using registers::kControl;
using registers::kControlAcknowledge;
using registers::kControlStart;
using registers::kStatus;
using test::TestHost;

// The rules of the registers are tested in core_registers_test.cpp, without the module.
class RegisterFileTest : public testing::Test {
 protected:
  RegisterFileTest() {
    binder.bind(host.socket, file.registers, "host_to_registers");
    binder.bind(bus.socket, file.local_bus, "bus_to_registers");
    file.done(done);
    file.start_out.bind(starts);
    settle();
  }
  static void settle() { sc_core::sc_start(sc_core::sc_time(1, sc_core::SC_NS)); }

  void control(std::uint32_t value) {
    ASSERT_EQ(host.write(kControl, value).status, tlm::TLM_OK_RESPONSE);
    settle();
  }

  test::MonitoringBinder binder;
  TestHost host{"test_host"};
  TestHost bus{"test_bus"};
  RegisterFile file{"file"};
  sc_core::sc_signal<bool> done{"done"};
  Collected<FrameStart> starts;
};

TEST_F(RegisterFileTest, ReadsAndWritesTheRegistersOnBothSockets) {
  EXPECT_EQ(host.write(registers::kLeftLutBase, 7).status, tlm::TLM_OK_RESPONSE);
  EXPECT_EQ(bus.read(registers::kLeftLutBase).word, 7U);
  EXPECT_EQ(file.stats().reads, 1U);
  EXPECT_EQ(file.stats().writes, 1U);
}

TEST_F(RegisterFileTest, HandsAStrobeToTheCoreWithTheAnnotatedTimeOfItsAccess) {
  std::uint32_t word = kControlStart;
  tlm::tlm_generic_payload payload;
  payload.set_command(tlm::TLM_WRITE_COMMAND);
  payload.set_address(kControl);
  payload.set_data_ptr(reinterpret_cast<unsigned char*>(&word));
  payload.set_data_length(4);
  payload.set_streaming_width(4);
  sc_core::sc_time delay(300, sc_core::SC_PS);
  host.socket->b_transport(payload, delay);
  ASSERT_EQ(starts.beats.size(), 1U);
  EXPECT_EQ(starts.beats[0].time_ps, 1300U);  // the test has begun at 1 ns
}

TEST_F(RegisterFileTest, DrivesTheInterruptAtTheEndOfAFrameAndAtItsAcknowledgement) {
  control(kControlStart);
  EXPECT_FALSE(done.read());
  file.finish_frame(5, false);
  settle();
  EXPECT_TRUE(done.read());
  control(kControlAcknowledge);
  EXPECT_FALSE(done.read());
}

TEST_F(RegisterFileTest, RefusesAccessesThatAreNotOneWordOfARegister) {
  const test::ExpectedReport refusal("/stereotlm/refused_access");
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
  EXPECT_EQ(host.read(registers::kLeftImageBase).word, 0U);
  binder.take_violations();
  EXPECT_EQ(host.write(registers::kEnd - 4, 0).status, tlm::TLM_OK_RESPONSE);
  EXPECT_EQ(host.write(registers::kEnd, 0).status, tlm::TLM_ADDRESS_ERROR_RESPONSE);
  EXPECT_EQ(host.read(registers::kEnd).status, tlm::TLM_ADDRESS_ERROR_RESPONSE);
}

TEST(RegisterMap, PlacesABaseInTheAddressesOfTheCrossbar) {
  EXPECT_EQ(registers::base_address(registers::base(0, 0)), 0U);
  EXPECT_EQ(registers::base_address(registers::base(1, 5)), (std::uint64_t{1} << 28U) + 20);
  EXPECT_EQ(registers::base_address(registers::base(63, (1U << 26U) - 1)), (std::uint64_t{1} << 34U) - 4);
}

}  // namespace
}  // namespace stereotlm::fpga
