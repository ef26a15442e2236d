// The core at fast fidelity against itself cycle by cycle: random boards, and what a host does with them,
// with every time, word and count. Each run is in a process of its own.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "models/fpga/register_map.h"
#include "models/kernels/rectification_table.h"
#include "models/testing/monitoring_binder.h"
#include "models/testing/test_host.h"
#include "platform/assembly/board.h"
#include "platform/figures/collect.h"
#include "tests/integration/core/preloaded_run.h"
#include "tests/support/board_of_random.h"
#include "tests/support/fork.h"
#include "tests/support/random_computer.h"

namespace stereotlm::fpga {
namespace {

using memory::crossbar_address;
using test::SplitMix64;
using Words = std::vector<std::uint32_t>;

// Every bank has room for each buffer of a frame, all of them filled, and words that no frame uses.
constexpr int kMostHeight = 12;
constexpr std::uint32_t kMostTableWords = 64 * kMostHeight;
constexpr std::uint32_t kLeftTable = 0;
constexpr std::uint32_t kRightTable = kLeftTable + kMostTableWords;
constexpr std::uint32_t kLeftImage = kRightTable + kMostTableWords;
constexpr std::uint32_t kRightImage = kLeftImage + kMostTableWords / 4;
constexpr std::uint32_t kDisparity = kRightImage + kMostTableWords / 4;
constexpr std::uint32_t kScratch = kDisparity + kMostTableWords / 4;
constexpr std::uint32_t kBankWords = kScratch + 2048;

platform::BoardConfig random_board(std::uint64_t seed) {
  test::RandomKnobs knobs = test::RandomKnobs::with_section_8();
  knobs.large_images = knobs.stripes = false;
  platform::BoardConfig board = test::board_config(test::make_random_computer(seed, knobs));
  board.image.height = std::min(board.image.height, kMostHeight);
  for (platform::BankConfig& bank : board.banks) bank.words = kBankWords;
  return board;
}

// A board and its host. The host makes one access after the other over the local bus; frames are started over
// the local bus too, or by somebody else at the registers, at any time.
class HostedRun {
 public:
  HostedRun(std::uint64_t seed, Fidelity fidelity)
      : random_(seed), config_(random_board(seed)), has_registers_(random_.chance(50)) {
    sc_core::sc_report_handler::set_actions("/stereotlm/refused_access", sc_core::SC_DO_NOTHING);
    board_ = std::make_unique<platform::Board>("board", config_, binder_, fidelity);
    StereoCore& core = board_->core;
    binder_.bind(bus_.socket, core.local_bus, "host_to_local_bus");
    if (has_registers_) {
      registers_ = std::make_unique<test::TestHost>("register_host");
      binder_.bind(registers_->socket, core.registers, "host_to_registers");
    }
    core.done(done_);
    sc_core::sc_start(sc_core::SC_ZERO_TIME);
    fill();
    // Each draws its own numbers, or the order of the two would matter.
    const std::uint64_t bus_seed = random_.next();
    const std::uint64_t register_seed = random_.next();
    sc_core::sc_spawn([this, bus_seed] { use_local_bus(SplitMix64(bus_seed)); });
    if (has_registers_)
      sc_core::sc_spawn([this, register_seed] { use_registers(SplitMix64(register_seed)); });
    sc_core::sc_spawn([this] {
      for (;;) {
        sc_core::wait(done_.posedge_event());
        note("done", Words());
      }
    });
    sc_core::sc_start(sc_core::sc_time(1, sc_core::SC_SEC));
  }

  // With what the kernel counts for itself at the two fidelities left out.
  std::string text() const {
    std::string text = notes_;
    const platform::BoardCounters counters = counters_of(*board_);
    // The tables matter to the bounds alone, which are not compared.
    const platform::Tables tables = platform::identity_tables(config_);
    for (const auto& [name, value] : test::figures(collect_statistics(config_, tables, *board_, counters)))
      text += name + ": " + std::to_string(value) + '\n';
    for (std::size_t bank = 0; bank < board_->banks.size(); ++bank) {
      text += "accesses: " + std::to_string(counters.banks[bank].accesses) + '\n';
      for (std::uint32_t word = 0; word < kBankWords; ++word) {
        if (word % 16 == 0) text += "\nwords " + std::to_string(word) + ':';
        text += ' ' + std::to_string(board_->banks[bank].words()[word]);
      }
    }
    return text;
  }
  std::size_t frames() const { return board_->core.frames().frame_cycles().size(); }

 private:
  std::uint32_t any_bank(SplitMix64& random) const {
    return static_cast<std::uint32_t>(random.between(0, static_cast<int>(config_.banks.size()) - 1));
  }
  void note(const std::string& what, const Words& words) {
    notes_ += what + " at " + sc_core::sc_time_stamp().to_string() + ':';
    for (const std::uint32_t word : words) notes_ += ' ' + std::to_string(word);
    notes_ += '\n';
  }

  void fill() {
    for (std::size_t bank = 0; bank < config_.banks.size(); ++bank) {
      Words words(kBankWords);
      for (std::uint32_t& word : words) word = static_cast<std::uint32_t>(random_.next());
      bus_.debug_write(crossbar_address(bank, 0), words);
      for (const std::uint32_t table : {kLeftTable, kRightTable})
        bus_.debug_write(crossbar_address(bank, table), entries(random_));
    }
  }

  // Odd picoseconds, so that nothing comes at the very time of something else.
  static void pause(SplitMix64& random) {
    const auto ps = static_cast<std::uint64_t>(random.mostly_small(0, 200, 20'000)) * 1000 + 1;
    sc_core::wait(sc_core::sc_time::from_value(ps));
  }

  // The word of a table for a pixel and its source. Joint tables have the same source on both sides, if the
  // registers of the offsets are 0.
  std::uint32_t entry(int column, int row, int from_column, int from_row) const {
    if (!config_.fpga.joint_tables) return kernels::make_entry(from_column, from_row);
    const int columns = 128 + from_column - column;
    const int rows = 64 + from_row - row;
    const auto side = static_cast<std::uint32_t>(rows << 8 | columns);
    return 0x8000'8000U | side << 16U | side;
  }
  // A table whose sources are the pixels themselves, or lie on slanted lines. A block may have no valid
  // entries, and seldom one points to another place, also outside the image.
  Words entries(SplitMix64& random) const {
    const auto [width, height] = config_.image;
    const bool is_slanted = random.chance(50);
    const int slope = is_slanted ? random.between(-16, 16) : 0;
    const int slant = is_slanted ? random.between(-16, 16) : 0;
    const int first_hole = random.chance(50) ? random.between(0, width - 1) : width;
    const auto wrapped = [](int place, int size) { return (place % size + size) % size; };
    Words entries;
    for (int row = 0; row < height; ++row) {
      for (int column = 0; column < width; ++column) {
        const int from_column = wrapped(column + (column * slope + row * slant) / 16, width);
        const int from_row = wrapped(row + column * slant / 32, height);
        entries.push_back(column >= first_hole ? 0 : entry(column, row, from_column, from_row));
      }
    }
    if (random.chance(5)) {
      const auto place = static_cast<std::size_t>(random.between(0, width * height - 1));
      entries[place] = kernels::make_entry(random.between(0, 2047), random.between(0, 2047));
    }
    return entries;
  }

  // The places of the buffers of the next frame. Now and then the disparities overlap another buffer, or a
  // buffer ends behind its bank, so that the frame is stepped cycle by cycle.
  std::vector<std::pair<std::uint64_t, std::uint32_t>> bases(SplitMix64& random) const {
    const auto in_any_bank = [&](std::uint32_t word) {
      return registers::base(any_bank(random), random.chance(2) ? kBankWords - 10 : word);
    };
    // Often the tables of the frame before.
    const auto table = [&](std::uint32_t word) {
      return random.chance(60) ? registers::base(0, word) : in_any_bank(word);
    };
    const std::uint32_t left_image = in_any_bank(kLeftImage);
    const std::uint32_t left_table = table(kLeftTable);
    std::uint32_t disparity = in_any_bank(kDisparity);
    if (random.chance(15))
      disparity = config_.allocation.left_lut && random.chance(50) ? left_table : left_image;
    std::vector<std::pair<std::uint64_t, std::uint32_t>> bases = {
        {registers::kLeftImageBase, left_image},
        {registers::kRightImageBase, in_any_bank(kRightImage)},
        {registers::kDisparityBase, disparity},
        {registers::kLeftLutBase, left_table},
        {registers::kRightLutBase, table(kRightTable)}};
    for (const std::uint64_t offset :
         {registers::kLeftColumns, registers::kLeftRows, registers::kRightColumns, registers::kRightRows})
      bases.emplace_back(offset, random.chance(80) ? 0 : static_cast<std::uint32_t>(random.between(-1, 1)));
    return bases;
  }
  bool is_idle() const { return frames_started_ == frames(); }

  // A burst that no frame minds: reads what it only reads, or scratch words. While no frame runs, it may also
  // write pictures and disparities, and a frame may begin within it.
  void access_words(SplitMix64& random) {
    const std::uint32_t bank = any_bank(random);
    const bool write = random.chance(50);
    Words words(static_cast<std::size_t>(random.mostly_small(1, 16, 200)));
    std::uint32_t first = kScratch + static_cast<std::uint32_t>(random.between(0, 300));
    if (is_idle() && random.chance(50))
      first = static_cast<std::uint32_t>(random.between(kLeftImage, kScratch - 200));
    else if (!write && random.chance(50))
      first = static_cast<std::uint32_t>(random.between(0, kDisparity - 200));
    for (std::uint32_t& word : words) word = static_cast<std::uint32_t>(random.next());
    bus_.access(write ? tlm::TLM_WRITE_COMMAND : tlm::TLM_READ_COMMAND, crossbar_address(bank, first), words);
    note((write ? "wrote " : "read ") + std::to_string(words.size()) + " words of bank " +
             std::to_string(bank) + " from " + std::to_string(first),
         write ? Words() : bus_.answers.back().words);
  }

  // New table entries, all or one at an end: over the bus, where a frame may begin within the burst, or by
  // debug transport.
  void change_table(SplitMix64& random) {
    Words words = entries(random);
    std::uint64_t address = crossbar_address(random.chance(50) ? 0 : any_bank(random),
                                             random.chance(50) ? kLeftTable : kRightTable);
    if (random.chance(40)) {
      const std::size_t place = random.chance(50) ? 0 : words.size() - 1;
      address += 4 * place;
      words = {random.chance(50) ? words[place] : 0};
    }
    if (random.chance(50)) {
      bus_.access(tlm::TLM_WRITE_COMMAND, address, words);
    } else {
      bus_.debug_write(address, words);
    }
  }

  void use_local_bus(SplitMix64 random) {
    for (int accesses = random.between(5, 60); accesses > 0; --accesses) {
      if (random.chance(70)) pause(random);
      const bool would_start = !has_registers_ && random.chance(50);
      // Whether the frame ends at the very time of an answer is nobody's business.
      if (would_start) sc_core::wait(sc_core::sc_time::from_value(1));
      if (would_start && is_idle()) {
        for (const auto& [base, value] : bases(random))
          bus_.access(tlm::TLM_WRITE_COMMAND, kLocalRegisters + base, value);
        ++frames_started_;
        note("start", Words());
        bus_.access(tlm::TLM_WRITE_COMMAND, kLocalRegisters + registers::kControl,
                    registers::kControlStart | registers::kControlAcknowledge);
      } else if (is_idle() && random.chance(30)) {
        change_table(random);
      } else {
        access_words(random);
      }
    }
  }

  void use_registers(SplitMix64 random) {
    for (int frames = random.between(1, 4); frames > 0; --frames) {
      // Long enough for a burst of the host to begin before the frame.
      sc_core::wait(
          sc_core::sc_time::from_value(static_cast<std::uint64_t>(random.between(0, 20'000)) * 1000 + 1));
      for (const auto& [base, value] : bases(random)) registers_->write(base, value);
      ++frames_started_;
      registers_->write(registers::kControl, registers::kControlStart | registers::kControlAcknowledge);
      sc_core::wait(done_.posedge_event());
      note("status", {registers_->read(registers::kStatus).word});
    }
  }

  SplitMix64 random_;
  platform::BoardConfig config_;
  bool has_registers_;
  test::MonitoringBinder binder_;
  test::TestHost bus_{"bus_host"};
  std::unique_ptr<test::TestHost> registers_;
  std::unique_ptr<platform::Board> board_;
  sc_core::sc_signal<bool> done_{"done"};
  std::size_t frames_started_ = 0;
  std::string notes_;
};

std::string difference(const std::string& fast, const std::string& cycle) {
  std::size_t at = 0;
  while (at < fast.size() && at < cycle.size() && fast[at] == cycle[at]) ++at;
  const std::size_t line = fast.rfind('\n', at) + 1;
  return "fast: " + fast.substr(line, 400) + "\ncycle: " + cycle.substr(line, 400);
}

TEST(StereoCoreRandom, TellsItsHostTheSameAtTheSameTimesAtEachFidelity) {
  const std::uint64_t seeds = test::random_boards(200);
  std::vector<test::ChildWork> jobs;
  for (std::uint64_t seed = 0; seed < seeds; ++seed) {
    for (const Fidelity fidelity : {Fidelity::kFast, Fidelity::kCycle})
      jobs.push_back([seed, fidelity] {
        const HostedRun run(seed, fidelity);
        return std::to_string(run.frames()) + " frames\n" + run.text();
      });
  }
  const std::vector<test::ChildResult> runs = test::run_in_children(jobs, 2);
  std::uint64_t without_frame = 0;
  for (std::uint64_t seed = 0; seed < seeds; ++seed) {
    const std::string& fast = runs[2 * seed].text;
    const std::string& cycle = runs[2 * seed + 1].text;
    ASSERT_NE(cycle.find(" frames\n"), std::string::npos) << "seed " << seed << ": " << cycle;
    without_frame += std::uint64_t{cycle.rfind("0 frames", 0) == 0};
    EXPECT_TRUE(fast == cycle) << "seed " << seed << '\n' << difference(fast, cycle);
    if (HasFailure()) return;
  }
  EXPECT_LT(without_frame, seeds / 5);
}

}  // namespace
}  // namespace stereotlm::fpga
