#include "models/host/cpu.h"

#include <gtest/gtest.h>

#include <functional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "models/host/host_memory.h"
#include "models/testing/expected_report.h"
#include "models/testing/monitoring_binder.h"
#include "tests/support/scripted_ends.h"

namespace stereotlm::host {
namespace {

using sc_core::sc_time;
using test::ExpectedReport;

constexpr std::uint64_t kMemoryBase = 0x8000'0000;
constexpr std::uint64_t kMemoryBytes = 0x1000;
const sc_time kAccessTime(300, sc_core::SC_NS);

class Line : public InterruptIf {
 public:
  void write(bool asserted) {
    asserted_ = asserted;
    changed_.notify(sc_core::SC_ZERO_TIME);
  }
  bool is_asserted() const override { return asserted_; }
  const sc_core::sc_event& changed_event() const override { return changed_; }

 private:
  bool asserted_ = false;
  sc_core::sc_event changed_;
};

class LambdaProgram : public Program {
 public:
  std::function<void(HostBus&)> body;
  void run(HostBus& bus) override { body(bus); }
};

// A processor with host memory, two interrupt lines, and registers behind a monitor. A register access waits
// for half of kAccessTime and annotates the other half.
class CpuTest : public testing::Test {
 protected:
  CpuTest() {
    binder.bind(cpu.bus, registers.socket, "cpu_to_registers");
    binder.bind(cpu.host_memory, memory.port, "cpu_to_memory");
    cpu.interrupts[0].bind(line_0);
    cpu.interrupts[1].bind(line_1);
    registers.on_blocking = [this](auto& payload, auto& delay) {
      auto* word = reinterpret_cast<std::uint32_t*>(payload.get_data_ptr());
      accesses.emplace_back(payload.is_write(), payload.get_address());
      if (payload.is_write()) written.push_back(*word);
      if (payload.is_read()) *word = static_cast<std::uint32_t>(payload.get_address() + 1);
      sc_core::wait(kAccessTime / 2);
      delay += kAccessTime / 2;
      payload.set_response_status(response);
    };
  }
  void simulate(std::function<void(HostBus&)> body) {
    program.body = std::move(body);
    sc_core::sc_start();
  }
  // Runs a program that must end with this report.
  void expect_report(std::function<void(HostBus&)> body, const std::string& text) {
    ExpectedReport report("/stereotlm/cpu");
    program.body = std::move(body);
    EXPECT_THROW(sc_core::sc_start(), sc_core::sc_report);
    EXPECT_EQ(report.text(), "cpu: " + text);
    EXPECT_FALSE(cpu.finished());
  }
  void drive(Line& line, bool value, const sc_time& at) {
    sc_core::sc_spawn([&line, value, at] {
      sc_core::wait(at);
      line.write(value);
    });
  }

  test::MonitoringBinder binder;
  LambdaProgram program;
  Cpu cpu{"cpu", {2, kMemoryBase}, program};
  test::ScriptedTarget registers{"registers"};
  HostMemory memory{"memory", kMemoryBytes};
  Line line_0;
  Line line_1;
  tlm::tlm_response_status response = tlm::TLM_OK_RESPONSE;
  std::vector<std::pair<bool, std::uint64_t>> accesses;
  std::vector<std::uint32_t> written;
};

TEST_F(CpuTest, RunsItsProgramOnceFromTimeZeroWithATransactionForEachAccess) {
  sc_time finished;
  sc_core::sc_spawn([&] {
    sc_core::wait(cpu.finished_event());
    finished = sc_core::sc_time_stamp();
    EXPECT_TRUE(cpu.finished());
  });
  int runs = 0;
  simulate([&](HostBus& bus) {
    ++runs;
    EXPECT_EQ(sc_core::sc_time_stamp(), sc_core::SC_ZERO_TIME);
    EXPECT_FALSE(cpu.finished());
    bus.write(0x10, 7);
    EXPECT_EQ(sc_core::sc_time_stamp(), kAccessTime);
    EXPECT_EQ(bus.read(0x20), 0x21U);
  });
  EXPECT_EQ(runs, 1);
  EXPECT_EQ(finished, 2 * kAccessTime);
  EXPECT_EQ(accesses, (std::vector<std::pair<bool, std::uint64_t>>{{true, 0x10}, {false, 0x20}}));
  EXPECT_EQ(written, std::vector<std::uint32_t>{7});
}

TEST_F(CpuTest, WaitsForAnyOfItsInterrupts) {
  drive(line_1, true, sc_time(5, sc_core::SC_US));
  drive(line_1, false, sc_time(6, sc_core::SC_US));
  drive(line_0, true, sc_time(9, sc_core::SC_US));
  std::vector<sc_time> times;
  simulate([&](HostBus& bus) {
    bus.wait_for_interrupt();
    times.push_back(sc_core::sc_time_stamp());
    while (line_1.is_asserted()) bus.read(0);
    bus.wait_for_interrupt();
    times.push_back(sc_core::sc_time_stamp());
  });
  EXPECT_EQ(times, (std::vector<sc_time>{sc_time(5, sc_core::SC_US), sc_time(9, sc_core::SC_US)}));
}

TEST_F(CpuTest, ReturnsAtOnceWhileAnInterruptIsAsserted) {
  drive(line_0, true, sc_time(1, sc_core::SC_US));
  simulate([](HostBus& bus) {
    bus.wait_for_interrupt();
    bus.read(0);
    bus.wait_for_interrupt();
    EXPECT_EQ(sc_core::sc_time_stamp(), sc_time(1, sc_core::SC_US) + kAccessTime);
  });
  EXPECT_TRUE(cpu.finished());
}

TEST_F(CpuTest, WaitsAgainWithoutAccessIfTheLineWasReleased) {
  drive(line_0, true, sc_time(1, sc_core::SC_US));
  drive(line_0, false, sc_time(2, sc_core::SC_US));
  drive(line_0, true, sc_time(5, sc_core::SC_US));
  simulate([](HostBus& bus) {
    bus.wait_for_interrupt();
    sc_core::wait(sc_time(2, sc_core::SC_US));
    bus.wait_for_interrupt();
    EXPECT_EQ(sc_core::sc_time_stamp(), sc_time(5, sc_core::SC_US));
  });
  EXPECT_TRUE(cpu.finished());
}

TEST_F(CpuTest, WaitsForEverWithoutInterrupt) {
  simulate([](HostBus& bus) { bus.wait_for_interrupt(); });
  EXPECT_FALSE(cpu.finished());
}

TEST_F(CpuTest, ReportsAProgramThatWaitsAgainWithoutServingTheInterrupt) {
  drive(line_0, true, sc_time(1, sc_core::SC_US));
  expect_report(
      [](HostBus& bus) {
        for (;;) bus.wait_for_interrupt();
      },
      "wait_for_interrupt: the line is still asserted, and no register was accessed since it returned last");
}

TEST_F(CpuTest, ThrowsABusErrorIntoTheProgram) {
  response = tlm::TLM_ADDRESS_ERROR_RESPONSE;
  const auto error_of = [](const std::function<void()>& access) -> std::string {
    try {
      access();
    } catch (const BusError& error) {
      return error.what();
    }
    return "";
  };
  simulate([&](HostBus& bus) {
    EXPECT_EQ(error_of([&] { bus.read(0x1234); }), "read of 0x1234: TLM_ADDRESS_ERROR_RESPONSE");
    EXPECT_EQ(error_of([&] { bus.write(0x20, 1); }), "write of 0x20: TLM_ADDRESS_ERROR_RESPONSE");
    EXPECT_EQ(sc_core::sc_time_stamp(), 2 * kAccessTime);
  });
  EXPECT_TRUE(cpu.finished());
}

TEST_F(CpuTest, ReportsABusErrorThatLeavesTheProgram) {
  response = tlm::TLM_GENERIC_ERROR_RESPONSE;
  expect_report([](HostBus& bus) { bus.read(4); }, "read of 0x4: TLM_GENERIC_ERROR_RESPONSE");
}

TEST_F(CpuTest, ReportsAnExceptionWithoutText) {
  expect_report([](HostBus&) { throw std::runtime_error(""); }, "");
}

TEST_F(CpuTest, ReportsAnExceptionOfAnUnknownType) {
  expect_report([](HostBus&) { throw 7; }, "exception of an unknown type");
}

TEST_F(CpuTest, PassesOnTheReportOfAModel) {
  registers.on_blocking = [](auto&, auto&) { SC_REPORT_ERROR("/stereotlm/other", "impossible"); };
  ExpectedReport report("/stereotlm/other");
  program.body = [](HostBus& bus) { bus.read(0); };
  EXPECT_THROW(sc_core::sc_start(), sc_core::sc_report);
  EXPECT_EQ(report.text(), "impossible");
}

TEST_F(CpuTest, GivesTheProgramHostMemoryInNoTime) {
  simulate([](HostBus& bus) {
    bus.memory(kMemoryBase + 8, 4)[1] = 5;
    EXPECT_EQ(bus.memory(kMemoryBase, kMemoryBytes)[9], 5);
    EXPECT_EQ(bus.memory(kMemoryBase + kMemoryBytes - 1, 1), bus.memory(kMemoryBase, 1) + kMemoryBytes - 1);
    EXPECT_EQ(bus.memory(kMemoryBase, 0), bus.memory(kMemoryBase, 1));
  });
  EXPECT_TRUE(cpu.finished());
  EXPECT_EQ(sc_core::sc_time_stamp(), sc_core::SC_ZERO_TIME);
}

TEST_F(CpuTest, RefusesBytesThatAreNotHostMemory) {
  expect_report(
      [](HostBus& bus) {
        EXPECT_THROW(bus.memory(kMemoryBase - 1, 1), std::out_of_range);
        EXPECT_THROW(bus.memory(0, 1), std::out_of_range);
        EXPECT_THROW(bus.memory(kMemoryBase + kMemoryBytes, 1), std::out_of_range);
        EXPECT_THROW(bus.memory(kMemoryBase, kMemoryBytes + 1), std::out_of_range);
        EXPECT_THROW(bus.memory(kMemoryBase + 1, kMemoryBytes), std::out_of_range);
        EXPECT_THROW(bus.memory(kMemoryBase + 4, UINT64_MAX), std::out_of_range);
        bus.memory(0x1000, 16);
      },
      "16 bytes at 0x1000: must be host memory");
}

// A program with 800 KiB of locals, as on a real machine.
TEST_F(CpuTest, GivesTheProgramALargeStack) {
  unsigned sum = 0;
  simulate([&sum](HostBus&) {
    volatile unsigned char bytes[800 * 1024];
    for (std::size_t i = 0; i < sizeof bytes; ++i) bytes[i] = 1;
    for (std::size_t i = 0; i < sizeof bytes; ++i) sum += bytes[i];
  });
  EXPECT_EQ(sum, 800U * 1024);
}

TEST(Cpu, RefusesANumberOfInterruptsOutsideItsRule) {
  LambdaProgram program;
  EXPECT_THROW(Cpu("a", {0, 0}, program), std::invalid_argument);
  EXPECT_THROW(Cpu("b", {65, 0}, program), std::invalid_argument);
}

}  // namespace
}  // namespace stereotlm::host
