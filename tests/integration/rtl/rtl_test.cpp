#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "models/fpga/register_map.h"
#include "platform/config/board_yaml.h"
#include "platform/records/conflicts.h"
#include "tests/integration/core/preloaded_run.h"
#include "tests/integration/rtl/rtl_board.h"
#include "tests/support/board_of_random.h"
#include "tests/support/fork.h"
#include "tests/support/plain_core.h"
#include "tests/support/random_board.h"

// The Verilog of models/rtl beside the model: the same random boards, cycle by cycle.
namespace stereotlm::test {
namespace {

using nlohmann::json;

json parameter_set(const std::string& name) {
  const json sets = json::parse(std::ifstream(STEREOTLM_RTL_SETS));
  return *std::find_if(sets.begin(), sets.end(), [&](const json& set) { return set["name"] == name; });
}

// A board that the core of this parameter set can have.
RandomBoard board_of(const json& set, std::uint64_t seed) {
  return make_random_board(seed, {}, [&](RandomBoard& board) {
    board.width = set["width"];
    board.height = set["height"];
    board.window = set["window"];
    board.disparities = set["disparities"];
    board.fetch = PlainFetch::kColumn;
    board.filter.reset();
    if (set.contains("filter")) {
      const json& filter = set["filter"];
      board.filter = ReferenceKernel{filter["size"], filter["weights"], filter["shift"]};
    }
    board.lr_tolerance.reset();
    if (!set["tolerance"].is_null()) board.lr_tolerance = set["tolerance"].get<int>();
    board.lane_fifo_slots = set["lane_fifo_slots"];
    board.result_fifo_words = set["result_fifo_words"];
    board.result_delay_cycles = set["result_delay_cycles"];
    const auto fix_table = [&](std::optional<PlainBuffer>& lut, const PlainBuffer& otherwise,
                               bool has_table) {
      if (!has_table) lut.reset();
      if (has_table && !lut) lut = otherwise;
    };
    fix_table(board.left_lut, board.left_image.back(), set["left_table"]);
    fix_table(board.right_lut, board.left_image.front(), set["right_table"]);
    board.banks.resize(std::min(board.banks.size(), kRtlBanks));
    const auto use_banks_there_are = [&](PlainBuffer& buffer) {
      for (int& bank : buffer.banks) bank %= static_cast<int>(board.banks.size());
    };
    for (auto* list : {&board.left_image, &board.right_image, &board.disparity})
      std::for_each(list->begin(), list->end(), use_banks_there_are);
    for (auto* lut : {&board.left_lut, &board.right_lut}) {
      if (*lut) use_banks_there_are(**lut);
    }
  });
}

// What a port of the core does in a cycle, in words.
struct Does {
  fpga::Intent intent;
  bool granted;
  std::size_t bank;
  std::uint64_t word;
  bool write = false;

  bool operator==(const Does& other) const {
    return intent == other.intent && (intent != fpga::Intent::kRequest ||
                                      (granted == other.granted && bank == other.bank && word == other.word));
  }
  std::string text() const {
    static constexpr std::array<const char*, 5> kIntents = {"", "passes", "is idle", "is blocked",
                                                            "is starved"};
    if (intent != fpga::Intent::kRequest) return kIntents.at(static_cast<std::size_t>(intent));
    return "asks for word " + std::to_string(word) + " of bank" + std::to_string(bank) +
           (granted ? ", granted" : ", stalled");
  }
};

// The cycles of a run, of the model or of the RTL.
struct Cycle {
  std::uint64_t number;  // from the start of the run
  std::uint64_t frame;
  std::array<Does, kRtlPorts> ports;
  bool consumes;
};
using Cycles = std::vector<Cycle>;

class ModelCycles : public fpga::CycleObserver {
 public:
  void cycle(const fpga::CoreCycle& now) override {
    Cycle cycle{now.cycle, now.frame.value(), {}, now.works};
    for (std::size_t port = 0; port < kRtlPorts; ++port) {
      const fpga::PortCycle& of_port = now.ports[port];
      cycle.ports[port] = {of_port.intent, of_port.granted, of_port.bank, of_port.address / 4,
                           fpga::kPortGroups[port].write};
    }
    cycles.push_back(cycle);
  }
  Cycles cycles;
};

Cycle cycle_of(std::uint64_t number, std::uint64_t frame, const RtlOutputs& outputs,
               bool host_writes = false) {
  const std::array<bool, kRtlPorts> writes = {false, false, false, false, true, host_writes};
  Cycle cycle{number, frame, {}, outputs.consumes};
  for (std::size_t port = 0; port < kRtlPorts; ++port) {
    const RtlOutputs::Port& of_port = outputs.ports[port];
    cycle.ports[port] = {static_cast<fpga::Intent>(of_port.state), of_port.granted,
                         fpga::registers::bank_of(of_port.address),
                         fpga::registers::first_word_of(of_port.address), writes[port]};
  }
  return cycle;
}

// The first difference in words; empty if there is none.
std::string first_difference(const Cycles& model, const Cycles& rtl) {
  for (std::size_t index = 0; index < std::min(model.size(), rtl.size()); ++index) {
    const Cycle& expected = model[index];
    const Cycle& got = rtl[index];
    const std::string where = "frame " + std::to_string(expected.frame) + ", cycle " +
                              std::to_string(expected.number) + " of the run: ";
    if (got.number != expected.number || got.frame != expected.frame)
      return where + "the RTL is in frame " + std::to_string(got.frame) + ", cycle " +
             std::to_string(got.number) + "\n";
    for (std::size_t port = 0; port < kRtlPorts; ++port) {
      if (got.ports[port] == expected.ports[port]) continue;
      return where + fpga::kPortGroups[port].name + " of the RTL " + got.ports[port].text() +
             "; that of the model " + expected.ports[port].text() + "\n";
    }
    if (got.consumes != expected.consumes)
      return where + "the matcher of " + (got.consumes ? "the RTL" : "the model") +
             " alone consumes a slot\n";
  }
  if (model.size() == rtl.size()) return {};
  return "the frames of the RTL have " + std::to_string(rtl.size()) + " cycles, those of the model " +
         std::to_string(model.size()) + "\n";
}

// The figures of a run (preloaded_run.h), counted from its cycles.
Figures figures_of(const Cycles& cycles, const std::vector<std::uint64_t>& frame_cycles, std::size_t banks) {
  static constexpr std::array<const char*, 5> kStates = {"", " passed", " idle", " blocked", " starved"};
  Figures all{{"frames", frame_cycles.size()}, {"cycles", cycles.size()}};
  for (std::size_t frame = 0; frame < frame_cycles.size(); ++frame)
    all["frame " + std::to_string(frame) + " cycles"] = frame_cycles[frame];
  for (const Cycle& cycle : cycles) {
    std::vector<std::vector<std::size_t>> asked_by(banks);
    for (std::size_t port = 0; port < kRtlPorts; ++port) {
      const Does& does = cycle.ports[port];
      const std::string name = fpga::kPortGroups[port].name;
      if (does.intent == fpga::Intent::kRequest) asked_by.at(does.bank).push_back(port);
      ++all[name + (does.intent != fpga::Intent::kRequest ? kStates.at(static_cast<std::size_t>(does.intent))
                    : does.granted                        ? " granted"
                                                          : " stalled")];
    }
    for (std::size_t bank = 0; bank < banks; ++bank) {
      const std::string name = "bank" + std::to_string(bank);
      const std::vector<std::size_t>& ports = asked_by[bank];
      const auto winner = std::find_if(ports.begin(), ports.end(),
                                       [&](std::size_t port) { return cycle.ports[port].granted; });
      if (ports.size() >= 2) ++all[name + " contended"];
      const bool is_busy = winner != ports.end();
      ++all[name + (is_busy ? " busy" : ports.empty() ? " idle" : " turnaround")];
      if (is_busy) ++all[name + (cycle.ports[*winner].write ? " writes" : " reads")];
      for (const std::size_t port : ports) {
        if (is_busy && port == *winner) continue;
        ++all[std::string(fpga::kPortGroups[port].name) + " blames " +
              (is_busy ? fpga::kPortGroups[*winner].name : "turnaround") + " in " + name];
      }
    }
  }
  return all;
}

// Without the figures that are 0.
Figures without_zeros(const Figures& all) {
  Figures some;
  for (const auto& [name, value] : all) {
    if (value != 0) some[name] = value;
  }
  return some;
}

std::string compare(const json& set, std::uint64_t seed) {
  const RandomBoard board = board_of(set, seed);
  const platform::BoardConfig config = board_config(board);
  const platform::Tables tables = board_tables(board);
  std::vector<host::StereoPair> pairs;
  for (std::size_t pair = 0; pair < board.pictures.size(); ++pair)
    pairs.push_back(stereo_pair(board, static_cast<int>(pair)));
  ModelCycles model;
  platform::Conflicts conflicts(config);
  const PreloadedRun expected = run_preloaded(config, tables, pairs, static_cast<std::uint64_t>(board.frames),
                                              fpga::Fidelity::kCycle, false, &conflicts, &model);

  const std::unique_ptr<RtlCore> core = rtl_cores().at(set["name"])();
  RtlBoard rtl(config, tables, *core);
  Cycles cycles;
  std::string text;
  std::uint64_t first_cycle = 0;
  for (int frame = 0; frame < board.frames; ++frame) {
    std::uint64_t number = first_cycle;
    const auto index = static_cast<std::size_t>(frame);
    const std::uint64_t most_cycles = expected.statistics.frame_cycles[index] + 100;
    kernels::GrayImage disparity;
    try {
      disparity = rtl.run_frame(pairs[index % pairs.size()], frame + 1 == board.frames, most_cycles,
                                [&](std::uint64_t now, const RtlOutputs& outputs) {
                                  cycles.push_back(cycle_of(number++, now, outputs));
                                });
    } catch (const std::exception& error) {
      return first_difference(model.cycles, cycles) + error.what() + "\n";
    }
    first_cycle += rtl.frame_cycles().back();
    const auto& wanted = expected.disparity[index].pixels;
    const auto wrong = std::mismatch(wanted.begin(), wanted.end(), disparity.pixels.begin());
    if (wrong.first == wanted.end()) continue;
    const auto place = wrong.first - wanted.begin();
    text += "frame " + std::to_string(frame) + ": pixel (" + std::to_string(place % board.width) + ", " +
            std::to_string(place / board.width) + ") of the RTL is " + std::to_string(*wrong.second) +
            ", of the model " + std::to_string(*wrong.first) + "\n";
  }
  return first_difference(model.cycles, cycles) + text +
         differences(without_zeros(figures_of(cycles, rtl.frame_cycles(), config.banks.size())),
                     without_zeros(figures(expected.statistics)));
}

// The host beside the frames: words that wait for their grant, and pauses. It reads what the core reads too,
// and writes words that the core does not use.
class RandomHost {
 public:
  RandomHost(const RandomBoard& board, RtlBoard& rtl) : random_(board.seed + 1000), rtl_(rtl) {
    for (const auto* list : {&board.left_image, &board.right_image, &board.disparity})
      banks_.push_back(list->front().banks.front());
    if (board.left_lut) banks_.push_back(board.left_lut->banks.front());
  }

  // What it asks for in a cycle. Sets the inputs of the RTL.
  std::optional<PlainHostRequest> ask() {
    RtlInputs& inputs = rtl_.inputs();
    if (!request_ && random_.chance(60)) {
      const int bank =
          banks_[static_cast<std::size_t>(random_.between(0, static_cast<int>(banks_.size()) - 1))];
      const auto last = static_cast<int>(rtl_.words(static_cast<std::size_t>(bank)).size()) - 1;
      const bool write = random_.chance(50);
      request_ = {{bank, static_cast<std::uint64_t>(write ? last : random_.between(0, last - 1))}, write};
      inputs.host_write_data = static_cast<std::uint32_t>(random_.next());
    }
    inputs.host_request = request_.has_value();
    if (!request_) return std::nullopt;
    inputs.host_write = request_->write;
    inputs.host_address = fpga::registers::base(static_cast<std::uint32_t>(request_->at.bank),
                                                static_cast<std::uint32_t>(request_->at.word));
    return request_;
  }
  // To be called with the outputs of that cycle. Returns what was read wrongly.
  std::string see(const RtlOutputs& outputs) {
    const auto due = std::exchange(coming_[0], std::exchange(coming_[1], std::nullopt));
    // The data come from the bank that the host asks then.
    const std::uint32_t asked = fpga::registers::bank_of(rtl_.inputs().host_address);
    if (due && due->first == asked && due->second != outputs.host_read_data)
      return "the host reads a wrong word\n";
    if (!outputs.ports.back().granted) return {};
    if (!request_->write) {
      const auto bank = static_cast<std::size_t>(request_->at.bank);
      coming_[rtl_.inputs().latency_2[bank] ? 1 : 0] = {bank, rtl_.words(bank)[request_->at.word]};
    }
    request_.reset();
    return {};
  }

 private:
  SplitMix64 random_;
  RtlBoard& rtl_;
  std::vector<int> banks_;  // of the frame's buffers
  std::optional<PlainHostRequest> request_;
  // Bank and word of the reads that are answered in the next cycle, and in the one after it.
  std::array<std::optional<std::pair<std::size_t, std::uint32_t>>, 2> coming_;
};

// A frame with the host, beside the plain loop of the contract.
std::string compare_with_host(const json& set, std::uint64_t seed) {
  const RandomBoard board = board_of(set, seed);
  platform::BoardConfig config = board_config(board);
  for (platform::BankConfig& bank : config.banks) bank.words += 2;  // the last one is the host's alone
  const std::unique_ptr<RtlCore> core = rtl_cores().at(set["name"])();
  RtlBoard rtl(config, board_tables(board), *core);
  const PlainCycleInput input = cycle_input(board);
  PlainCore plain(input);
  RandomHost host(board, rtl);
  std::string text;
  Cycles cycles;
  plain.start_frame(0);
  auto request = host.ask();
  rtl.run_frame(stereo_pair(board, 0), true, 1'000'000, [&](std::uint64_t frame, const RtlOutputs& outputs) {
    const std::uint64_t now = cycles.size();
    cycles.push_back(cycle_of(now, frame, outputs, request && request->write));
    if (plain.step(static_cast<std::int64_t>(now), request) != outputs.ports.back().granted && text.empty())
      text = "cycle " + std::to_string(now) + ": the host " + cycles.back().ports.back().text() +
             " by the RTL\n";
    text += host.see(outputs);
    request = host.ask();
  });
  PlainCycleResult expected = plain.result();
  expected.frame_cycles = rtl.frame_cycles();
  return text + differences(without_zeros(figures_of(cycles, rtl.frame_cycles(), config.banks.size())),
                            without_zeros(figures(expected)));
}

class Rtl : public testing::TestWithParam<std::string> {};

std::vector<std::string> names_of_cores() {
  std::vector<std::string> names;
  for (const auto& [name, make] : rtl_cores()) names.push_back(name);
  return names;
}
INSTANTIATE_TEST_SUITE_P(Set, Rtl, testing::ValuesIn(names_of_cores()),
                         [](const auto& suite) { return suite.param; });

// `compare`: one of the functions above.
void expect_equal(const std::string& core, std::string (*compare)(const json& set, std::uint64_t seed)) {
  const json set = parameter_set(core);
  const std::uint64_t seeds = random_boards(25);
  std::vector<ChildWork> jobs;
  for (std::uint64_t seed = 0; seed < seeds; ++seed)
    jobs.push_back([&set, seed, compare] { return compare(set, seed); });
  const std::vector<ChildResult> results = run_in_children(jobs, 2, std::chrono::minutes(9));
  for (std::uint64_t seed = 0; seed < seeds && !testing::Test::HasFailure(); ++seed) {
    EXPECT_TRUE(results[seed].ok()) << "seed " << seed << ":\n"
                                    << results[seed].text
                                    << platform::to_yaml(board_config(board_of(set, seed)));
  }
}

TEST_P(Rtl, IsTheModelCycleByCycleOnRandomBoards) { expect_equal(GetParam(), compare); }

TEST_P(Rtl, IsThePlainLoopWithTheHostBesideAFrame) { expect_equal(GetParam(), compare_with_host); }

}  // namespace
}  // namespace stereotlm::test
