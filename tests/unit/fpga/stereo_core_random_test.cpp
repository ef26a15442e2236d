// The core at fast fidelity against itself cycle by cycle: random boards, and what a host does with them,
// with every time, word and count. Each run is in a process of its own.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "models/fpga/register_map.h"
#include "models/memory/ssram_bank.h"
#include "models/testing/monitoring_binder.h"
#include "models/testing/test_host.h"
#include "tests/support/fork.h"
#include "tests/unit/fpga/core_figures.h"
#include "tests/unit/fpga/random_core.h"

namespace stereotlm::fpga {
namespace {

using memory::crossbar_address;
using test::SplitMix64;
using Words = std::vector<std::uint32_t>;

// Every bank has room for each buffer of a frame, all of them filled, and words that no frame uses.
constexpr std::uint32_t kMostTableWords = 64 * 12;
constexpr std::uint32_t kLeftTable = 0;
constexpr std::uint32_t kRightTable = kLeftTable + kMostTableWords;
constexpr std::uint32_t kLeftImage = kRightTable + kMostTableWords;
constexpr std::uint32_t kRightImage = kLeftImage + kMostTableWords / 4;
constexpr std::uint32_t kDisparity = kRightImage + kMostTableWords / 4;
constexpr std::uint32_t kScratch = kDisparity + kMostTableWords / 4;
constexpr std::uint32_t kBankWords = kScratch + 512;

StereoCoreConfig random_board(SplitMix64& random, Fidelity fidelity) {
  StereoCoreConfig board;
  board.fidelity = fidelity;
  board.core = random_core(random, 64);
  board.core.height = std::min(board.core.height, 12);
  draw_units(random, board.core);
  draw_rows(random, board.core);
  draw_cost(random, board.core);
  const std::vector<double> clocks = {40, 50, 80};
  board.core.clock_mhz = clocks[static_cast<std::size_t>(random.between(0, 2))];
  board.local_bus.clock_mhz =
      random.chance(50) ? board.core.clock_mhz : clocks[static_cast<std::size_t>(random.between(0, 2))];
  board.memory.arbiter = random_arbiter(random);
  for (int banks = random.between(1, 8); banks > 0; --banks) {
    memory::SsramBankConfig bank = random_bank(random);
    bank.words = kBankWords;
    bank.clock_mhz = board.core.clock_mhz;
    board.memory.banks.push_back(bank);
  }
  return board;
}

// A board and its host. The host makes one access after the other over the local bus; frames are started over
// the local bus too, or by somebody else at the registers, at any time.
class HostedRun {
 public:
  HostedRun(std::uint64_t seed, Fidelity fidelity)
      : random_(seed), board_(random_board(random_, fidelity)), has_registers_(random_.chance(50)) {
    core_ = std::make_unique<StereoCore>("core", board_, binder_);
    for (const memory::SsramBankConfig& bank : board_.memory.banks) {
      const std::string number = std::to_string(banks_.size());
      banks_.push_back(std::make_unique<memory::SsramBank>(("ssram" + number).c_str(), bank));
      binder_.bind(core_->banks[banks_.size() - 1], banks_.back()->port, "crossbar_to_bank" + number);
    }
    binder_.bind(bus_.socket, core_->local_bus, "host_to_local_bus");
    if (has_registers_) {
      registers_ = std::make_unique<test::TestHost>("register_host");
      binder_.bind(registers_->socket, core_->registers, "host_to_registers");
    }
    core_->done(done_);
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
    sc_core::sc_start(sc_core::sc_time(20, sc_core::SC_MS));
  }

  // With what the kernel counts for itself at the two fidelities left out.
  std::string text() const {
    std::string text = notes_ + CoreFigures(*core_).text();
    for (std::size_t bank = 0; bank < banks_.size(); ++bank) {
      const memory::SsramBank::Stats& stats = banks_[bank]->stats();
      text += "accesses: " +
              std::to_string(stats.reads + stats.writes + core_->crossbar().direct_accesses(bank) +
                             core_->frames().direct_counts().accesses[bank]) +
              '\n';
      for (std::uint32_t word = 0; word < kBankWords; ++word) {
        if (word % 16 == 0) text += "\nwords " + std::to_string(word) + ':';
        text += ' ' + std::to_string(banks_[bank]->words()[word]);
      }
    }
    return text;
  }
  std::size_t frames() const { return core_->frames().frame_cycles().size(); }

 private:
  int banks() const { return static_cast<int>(banks_.size()); }
  void note(const std::string& what, const Words& words) {
    notes_ += what + " at " + sc_core::sc_time_stamp().to_string() + ':';
    for (const std::uint32_t word : words) notes_ += ' ' + std::to_string(word);
    notes_ += '\n';
  }

  void fill() {
    for (std::size_t bank = 0; bank < banks_.size(); ++bank) {
      Words words(kBankWords);
      for (std::uint32_t& word : words) word = static_cast<std::uint32_t>(random_.next());
      bus_.debug_write(crossbar_address(bank, 0), words);
      for (const std::uint32_t table : {kLeftTable, kRightTable})
        bus_.debug_write(crossbar_address(bank, table), random_entries(random_, board_.core));
    }
  }

  // Odd picoseconds, so that nothing comes at the very time of something else.
  static void pause(SplitMix64& random) {
    const auto ps = static_cast<std::uint64_t>(random.mostly_small(0, 200, 20'000)) * 1000 + 1;
    sc_core::wait(sc_core::sc_time::from_value(ps));
  }

  // The places of the buffers of the next frame. Now and then the disparities overlap the left image, so that
  // the frame is stepped cycle by cycle.
  std::vector<std::pair<std::uint64_t, std::uint32_t>> bases(SplitMix64& random) const {
    const auto in_any_bank = [&](std::uint32_t word) {
      return registers::base(static_cast<std::uint32_t>(random.between(0, banks() - 1)), word);
    };
    const std::uint32_t left_image = in_any_bank(kLeftImage);
    return {{registers::kLeftImageBase, left_image},
            {registers::kRightImageBase, in_any_bank(kRightImage)},
            {registers::kDisparityBase, random.chance(15) ? left_image : in_any_bank(kDisparity)},
            {registers::kLeftLutBase, in_any_bank(kLeftTable)},
            {registers::kRightLutBase, in_any_bank(kRightTable)}};
  }
  bool is_idle() const { return frames_started_ == core_->frames().frame_cycles().size(); }

  // A burst that no frame minds: reads what it only reads, or scratch words.
  void access_words(SplitMix64& random) {
    const auto bank = static_cast<std::uint64_t>(random.between(0, banks() - 1));
    const bool write = random.chance(50);
    Words words(static_cast<std::size_t>(random.mostly_small(1, 16, 200)));
    std::uint32_t first = kScratch + static_cast<std::uint32_t>(random.between(0, 300));
    if (!write && random.chance(50)) first = static_cast<std::uint32_t>(random.between(0, kDisparity - 200));
    for (std::uint32_t& word : words) word = static_cast<std::uint32_t>(random.next());
    bus_.access(write ? tlm::TLM_WRITE_COMMAND : tlm::TLM_READ_COMMAND, crossbar_address(bank, first), words);
    note((write ? "wrote " : "read ") + std::to_string(words.size()) + " words of bank " +
             std::to_string(bank) + " from " + std::to_string(first),
         write ? Words() : bus_.answers.back().words);
  }

  // New table entries while no frame runs: over the bus, or behind its back.
  void change_table(SplitMix64& random) {
    const auto bank = static_cast<std::uint64_t>(random.between(0, banks() - 1));
    const Words entries = random_entries(random, board_.core);
    const std::uint64_t address = crossbar_address(bank, random.chance(50) ? kLeftTable : kRightTable);
    const int how = random.between(0, 9);
    if (how < 5) {
      bus_.access(tlm::TLM_WRITE_COMMAND, address, entries);
    } else {
      bus_.debug_write(address, entries);
    }
  }

  void use_local_bus(SplitMix64 random) {
    for (int accesses = random.between(5, 60); accesses > 0; --accesses) {
      if (random.chance(70)) pause(random);
      const bool would_start = !has_registers_ && random.chance(50);
      // Whether the frame ends at the very time of an answer is nobody's business.
      if (would_start) sc_core::wait(sc_core::sc_time::from_value(1));
      if (would_start && is_idle()) {
        if (random.chance(30)) change_table(random);
        for (const auto& [base, value] : bases(random))
          bus_.access(tlm::TLM_WRITE_COMMAND, kLocalRegisters + base, value);
        ++frames_started_;
        note("start", Words());
        bus_.access(tlm::TLM_WRITE_COMMAND, kLocalRegisters + registers::kControl,
                    registers::kControlStart | registers::kControlAcknowledge);
      } else {
        access_words(random);
      }
    }
  }

  void use_registers(SplitMix64 random) {
    for (int frames = random.between(1, 4); frames > 0; --frames) {
      pause(random);
      for (const auto& [base, value] : bases(random)) registers_->write(base, value);
      registers_->write(registers::kControl, registers::kControlStart | registers::kControlAcknowledge);
      sc_core::wait(done_.posedge_event());
    }
  }

  SplitMix64 random_;
  StereoCoreConfig board_;
  bool has_registers_;
  test::MonitoringBinder binder_;
  test::TestHost bus_{"bus_host"};
  std::unique_ptr<test::TestHost> registers_;
  std::unique_ptr<StereoCore> core_;
  std::vector<std::unique_ptr<memory::SsramBank>> banks_;
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
  const char* const wanted = std::getenv("STEREOTLM_RANDOM_BOARDS");
  const std::uint64_t seeds = wanted != nullptr ? std::stoull(wanted) : 300;
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
