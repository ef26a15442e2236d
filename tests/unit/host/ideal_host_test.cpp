#include "models/host/ideal_host.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <memory>
#include <ostream>
#include <stdexcept>
#include <vector>

#include "models/fpga/register_map.h"
#include "models/testing/expected_report.h"
#include "models/testing/monitoring_binder.h"
#include "tests/support/scripted_ends.h"

namespace stereotlm::host {
namespace {

namespace registers_of = fpga::registers;
using kernels::GrayImage;
using sc_core::sc_time;
using test::ExpectedReport;

constexpr int kWidth = 4;
constexpr int kHeight = 2;
constexpr std::size_t kPixels = std::size_t{kWidth} * kHeight;
const sc_time kFrameTime(100, sc_core::SC_NS);

// Frame f: left pixels 10 f + 1, right pixels 10 f + 2.
class Source : public FrameSource {
 public:
  const StereoPair& pair(std::uint64_t frame) override {
    asked.push_back(frame);
    const auto base = static_cast<std::uint8_t>(10 * frame);
    pair_.left = GrayImage(width, kHeight, static_cast<std::uint8_t>(base + 1));
    pair_.right = GrayImage(kWidth, height, static_cast<std::uint8_t>(base + 2));
    return pair_;
  }
  int width = kWidth;    // width of left pictures
  int height = kHeight;  // height of right pictures
  std::vector<std::uint64_t> asked;

 private:
  StereoPair pair_;
};

class Sink : public FrameSink {
 public:
  void take(std::uint64_t frame, const GrayImage& disparity) override {
    frames.push_back(frame);
    images.push_back(disparity);
    times.push_back(sc_core::sc_time_stamp());
  }
  std::vector<std::uint64_t> frames;
  std::vector<GrayImage> images;
  std::vector<sc_time> times;
};

// Registers and memory of a core. A frame takes it kFrameTime; then the disparity buffer is filled with the
// sum of a left and a right pixel.
class IdealHostTest : public testing::Test {
 public:
  void build(const IdealHostConfig& host_config, const kernels::RectificationTable* left_table = nullptr,
             const kernels::RectificationTable* right_table = nullptr) {
    host = std::make_unique<IdealHost>("host", host_config, left_table, right_table, source, sink);
    binder.bind(host->registers, register_target.socket, "host_to_registers");
    binder.bind(host->memory, memory_target.socket, "host_to_memory");
    host->done(done);
    register_target.on_blocking = [this](auto& payload, auto&) { access_register(payload); };
    memory_target.on_debug = [this](auto& payload) { return access_memory(payload); };
    sc_core::sc_spawn([this] {
      for (;;) {
        sc_core::wait(strobe);
        done.write(false);
        sc_core::wait(kFrameTime);
        pictures.push_back({buffer(registers_of::kLeftImageBase)[kPixels - 1],
                            buffer(registers_of::kRightImageBase)[kPixels - 1]});
        std::fill_n(buffer(registers_of::kDisparityBase), kPixels,
                    static_cast<std::uint8_t>(pictures.back()[0] + pictures.back()[1]));
        status = status_of_done;
        done.write(true);
      }
    });
  }
  IdealHostConfig config(std::uint64_t frames) const {
    IdealHostConfig host_config;
    host_config.width = kWidth;
    host_config.height = kHeight;
    host_config.frames = frames;
    host_config.buffers.left_images = {registers_of::base(0, 0)};
    host_config.buffers.right_images = {registers_of::base(1, 0)};
    host_config.buffers.disparities = {registers_of::base(2, 0)};
    return host_config;
  }

  void access_register(tlm::tlm_generic_payload& payload) {
    auto* word = reinterpret_cast<std::uint32_t*>(payload.get_data_ptr());
    if (refuse_registers) {
      payload.set_response_status(tlm::TLM_ADDRESS_ERROR_RESPONSE);
      return;
    }
    payload.set_response_status(tlm::TLM_OK_RESPONSE);
    if (payload.is_read()) {
      if (refuse_reads_from-- <= 0) payload.set_response_status(tlm::TLM_ADDRESS_ERROR_RESPONSE);
      *word = status;
      return;
    }
    written[payload.get_address()].push_back(*word);
    if (payload.get_address() == registers_of::kControl) {
      controls.push_back(*word);
      if (!starts) return;
      status = registers_of::kStatusBusy;
      strobe.notify(sc_core::SC_ZERO_TIME);
    }
  }
  unsigned access_memory(tlm::tlm_generic_payload& payload) {
    const std::size_t length = std::min<std::size_t>(payload.get_data_length(), most_bytes);
    if (payload.is_read()) {
      std::copy_n(at(payload.get_address()), length, payload.get_data_ptr());
    } else {
      std::copy_n(payload.get_data_ptr(), length, at(payload.get_address()));
    }
    return static_cast<unsigned>(length);
  }
  std::uint8_t* at(std::uint64_t address) {
    return banks.at(address >> 28U).data() + (address & 0x0FFF'FFFFU);
  }
  // The error leaves the host's process and ends the simulation after `frames` results.
  void expect_report(const std::string& text, std::size_t frames = 0) {
    ExpectedReport report("/stereotlm/ideal_host");
    EXPECT_THROW(sc_core::sc_start(), sc_core::sc_report);
    EXPECT_EQ(report.text(), text);
    EXPECT_EQ(sink.frames.size(), frames);
    EXPECT_EQ(host->frames_done(), frames);
    EXPECT_FALSE(host->finished());
  }

  // The buffer that a base register names now.
  std::uint8_t* buffer(std::uint64_t base_register) {
    return at(registers_of::base_address(written[base_register].back()));
  }

  test::MonitoringBinder binder;
  test::ScriptedTarget register_target{"register_target"};
  test::ScriptedTarget memory_target{"memory_target"};
  sc_core::sc_signal<bool> done{"done"};
  sc_core::sc_event strobe{"strobe"};
  std::array<std::array<std::uint8_t, 256>, 6> banks{};
  std::size_t most_bytes = 256;  // longest access that the memory takes whole
  bool refuse_registers = false;
  int refuse_reads_from = 1000;  // number of the first register read that is refused
  bool starts = true;            // false: the core ignores the strobe
  std::uint32_t status = 0;
  std::uint32_t status_of_done = registers_of::kStatusDone;
  std::map<std::uint64_t, std::vector<std::uint32_t>> written;
  std::vector<std::uint32_t> controls;
  std::vector<std::array<std::uint8_t, 2>> pictures;  // last pixels of each frame's pair
  Source source;
  Sink sink;
  std::unique_ptr<IdealHost> host;
};

// random_boards_test.cpp compares runs with tables and with lists of buffers.
TEST_F(IdealHostTest, RunsEachFrameWithItsOwnPairInNoTimeOfItsOwn) {
  build(config(3));
  sc_core::sc_start();
  EXPECT_EQ(source.asked, (std::vector<std::uint64_t>{0, 1, 2}));
  EXPECT_EQ(pictures, (std::vector<std::array<std::uint8_t, 2>>{{1, 2}, {11, 12}, {21, 22}}));
  EXPECT_EQ(sink.frames, (std::vector<std::uint64_t>{0, 1, 2}));
  for (int frame = 0; frame < 3; ++frame) {
    EXPECT_EQ(sink.images[static_cast<std::size_t>(frame)],
              GrayImage(kWidth, kHeight, static_cast<std::uint8_t>(20 * frame + 3)));
  }
  EXPECT_EQ(sink.times, (std::vector<sc_time>{kFrameTime, 2 * kFrameTime, 3 * kFrameTime}));
  EXPECT_EQ(sc_core::sc_time_stamp(), 3 * kFrameTime);
  EXPECT_TRUE(host->finished());
  EXPECT_EQ(host->frames_done(), 3U);
  // Each strobe acknowledges the frame before.
  const std::uint32_t both = registers_of::kControlAcknowledge | registers_of::kControlStart;
  EXPECT_EQ(controls, (std::vector<std::uint32_t>{both, both, both}));
  // Sides without tables.
  EXPECT_EQ(written.count(registers_of::kLeftLutBase), 0U);
  EXPECT_EQ(written.count(registers_of::kRightLutBase), 0U);
}

struct Fault {
  const char* name;
  std::function<void(IdealHostTest&)> set;
  const char* text;
  bool at_start = true;  // true: at the start of the first frame; false: at its end
};
void PrintTo(const Fault& fault, std::ostream* out) { *out << fault.name; }

class IdealHostFault : public IdealHostTest, public testing::WithParamInterface<Fault> {};

TEST_P(IdealHostFault, IsReportedAndEndsTheRun) {
  build(config(2));
  GetParam().set(*this);
  expect_report(GetParam().text);
  EXPECT_EQ(sc_core::sc_time_stamp(), GetParam().at_start ? sc_core::SC_ZERO_TIME : kFrameTime);
}

// The host reads the status once to start a frame and once at its end.
INSTANTIATE_TEST_SUITE_P(
    IdealHost, IdealHostFault,
    testing::Values(
        Fault{"left_picture_of_another_size", [](auto& test) { test.source.width = kWidth + 4; },
              "frame 0: picture of 8 x 2 for images of 4 x 2"},
        Fault{"right_picture_of_another_size", [](auto& test) { test.source.height = 1; },
              "frame 0: picture of 4 x 1 for images of 4 x 2"},
        Fault{"memory_takes_a_part_of_a_buffer", [](auto& test) { test.most_bytes = kPixels - 1; },
              "the buffer at base 0 takes 7 of 8 bytes"},
        Fault{"register_refuses_a_write", [](auto& test) { test.refuse_registers = true; },
              "register 16 refuses a write"},
        Fault{"status_refuses_the_first_read", [](auto& test) { test.refuse_reads_from = 0; },
              "register 4 refuses a read"},
        Fault{"status_refuses_the_second_read", [](auto& test) { test.refuse_reads_from = 1; },
              "register 4 refuses a read", false},
        Fault{"core_does_not_start", [](auto& test) { test.starts = false; },
              "frame 0: the core refuses to start with the bases left_image 0x00000000, right_image "
              "0x04000000, disparity 0x08000000"},
        Fault{
            "core_reports_an_error",
            [](auto& test) { test.status_of_done = registers_of::kStatusDone | registers_of::kStatusError; },
            "frame 0: the core reports an error", false}),
    [](const auto& tested) { return tested.param.name; });

TEST_F(IdealHostTest, RefusesJointTablesThatDoNotFitOrOfOneSideOnly) {
  IdealHostConfig joint = config(1);
  joint.buffers.left_lut = registers_of::base(3, 0);
  joint.buffers.has_joint_tables = true;
  const kernels::RectificationTable table = kernels::identity_table(kWidth, kHeight);
  kernels::RectificationTable wide = table;
  wide.entries.front() = kernels::make_entry(256, 0);
  EXPECT_THROW(IdealHost("a", joint, &table, &wide, source, sink), std::invalid_argument);
  EXPECT_THROW(IdealHost("b", joint, &table, nullptr, source, sink), std::invalid_argument);
}

TEST_F(IdealHostTest, ReportsACoreThatDoesNotStartASecondTime) {
  IdealHostConfig lists = config(2);
  lists.buffers.disparities = {registers_of::base(2, 0), registers_of::base(2, 8)};
  lists.buffers.left_lut = registers_of::base(3, 0);
  lists.buffers.right_lut = registers_of::base(4, 0);
  const kernels::RectificationTable table = kernels::identity_table(kWidth, kHeight);
  build(lists, &table, &table);
  sc_core::sc_start(kFrameTime / 2);
  starts = false;
  expect_report(
      "frame 1: the core refuses to start with the bases left_image 0x00000000, right_image 0x04000000, "
      "disparity 0x08000008, left_lut 0x0c000000, right_lut 0x10000000",
      1);
}

// The report has no effect here, so that only the host itself can stop the run.
TEST_F(IdealHostTest, StopsAtAnErrorThatDoesNotEndTheSimulation) {
  build(config(2));
  starts = false;
  sc_core::sc_report_handler::set_actions("/stereotlm/ideal_host", sc_core::SC_ERROR, sc_core::SC_DO_NOTHING);
  ExpectedReport report("/stereotlm/ideal_host");
  sc_core::sc_start();
  EXPECT_FALSE(sc_core::sc_pending_activity());
  EXPECT_FALSE(host->finished());
  EXPECT_EQ(controls.size(), 1U);
}

TEST_F(IdealHostTest, RefusesAnEmptyListATableWithoutBufferAndABufferWithoutTable) {
  const kernels::RectificationTable table = kernels::identity_table(kWidth, kHeight);
  EXPECT_THROW(IdealHost("a", config(1), &table, nullptr, source, sink), std::invalid_argument);
  IdealHostConfig with_buffer = config(1);
  with_buffer.buffers.right_lut = registers_of::base(3, 0);
  EXPECT_THROW(IdealHost("b", with_buffer, nullptr, nullptr, source, sink), std::invalid_argument);
  IdealHostConfig empty = config(1);
  empty.buffers.disparities.clear();
  EXPECT_THROW(IdealHost("c", empty, nullptr, nullptr, source, sink), std::invalid_argument);
}

}  // namespace
}  // namespace stereotlm::host
