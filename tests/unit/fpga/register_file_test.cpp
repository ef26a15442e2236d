#include "models/fpga/register_file.h"

#include <gtest/gtest.h>

#include "models/testing/expected_report.h"
#include "models/testing/monitoring_binder.h"
#include "models/testing/test_host.h"
#include "tests/support/refused_access.h"
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
  const auto write = tlm::TLM_WRITE_COMMAND;
  constexpr std::uint64_t kBase = registers::kLeftImageBase;
  const test::RefusedAccess accesses[] = {
      {tlm::TLM_BURST_ERROR_RESPONSE, write, kBase, 1, 8},
      {tlm::TLM_BURST_ERROR_RESPONSE, write, kBase, 3, 8},
      {tlm::TLM_BURST_ERROR_RESPONSE, write, kBase, 8, 8},
      {tlm::TLM_BURST_ERROR_RESPONSE, write, kBase, 4, 3},
      {tlm::TLM_BYTE_ENABLE_ERROR_RESPONSE, write, kBase, 4, 4, 4},
      {tlm::TLM_ADDRESS_ERROR_RESPONSE, write, kBase + 2},
      {tlm::TLM_COMMAND_ERROR_RESPONSE, tlm::TLM_IGNORE_COMMAND, kBase},
  };
  for (const test::RefusedAccess& access : accesses) test::expect_refused(host.socket, access);
  EXPECT_EQ(file.stats().errors, std::size(accesses));
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
