#include "tests/integration/core/preloaded_run.h"

#include <gtest/gtest.h>

#include <optional>
#include <systemc>

#include "models/testing/monitoring_binder.h"
#include "platform/assembly/preloaded_system.h"
#include "platform/figures/collect.h"

namespace stereotlm::test {
namespace {

class PairsInTurn : public host::FrameSource {
 public:
  explicit PairsInTurn(const std::vector<host::StereoPair>& pairs) : pairs_(pairs) {}
  const host::StereoPair& pair(std::uint64_t frame) override { return pairs_[frame % pairs_.size()]; }

 private:
  const std::vector<host::StereoPair>& pairs_;
};

class KeptFrames : public host::FrameSink {
 public:
  void take(std::uint64_t frame, const kernels::GrayImage& disparity) override {
    EXPECT_EQ(frame, disparities.size());
    disparities.push_back(disparity);
  }
  std::vector<kernels::GrayImage> disparities;
};

std::string frame_key(std::size_t frame) { return "frame " + std::to_string(frame) + " cycles"; }

std::string blame_key(const std::string& port, const std::string& bank, const std::string& by) {
  return port + " blames " + by + " in " + bank;
}

}  // namespace

PreloadedRun run_preloaded(const platform::BoardConfig& board, const platform::Tables& tables,
                           const std::vector<host::StereoPair>& pairs, std::uint64_t frames,
                           fpga::Fidelity fidelity, bool with_rows, platform::Conflicts* conflicts,
                           fpga::CycleObserver* observer) {
  PairsInTurn source(pairs);
  KeptFrames sink;
  MonitoringBinder binder;
  platform::PreloadedSystem system("system", board, tables, frames, source, sink, binder, fidelity);
  if (with_rows) system.board.core.frames().record_rows();
  if (conflicts != nullptr) system.board.core.frames().record(conflicts->recorder());
  std::optional<fpga::CycleRecorder> cycles;
  if (observer != nullptr) {
    cycles.emplace(platform::core_config(board), conflicts->recorder(), fpga::CycleWindow{}, *observer);
    if (tables.left) cycles->set_entries(fpga::Side::kLeft, tables.left->entries.data());
    if (tables.right) cycles->set_entries(fpga::Side::kRight, tables.right->entries.data());
    system.board.core.frames().record(*cycles);
  }
  sc_core::sc_start();
  EXPECT_TRUE(system.host.finished());
  // Those of the host, of the registers and of the results; of the readers in each lane; one to each bank.
  const std::size_t tables_bound =
      (tables.left ? 1U : 0U) + (tables.right && !board.fpga.joint_tables ? 1U : 0U);
  EXPECT_EQ(binder.monitors().size(),
            5 + static_cast<std::size_t>(board.fpga.lanes) * (2 + tables_bound) + board.banks.size());
  return {platform::collect_statistics(board, tables, system.board), std::move(sink.disparities),
          system.board.core.frames().take_rows()};
}

Figures figures(const platform::Statistics& statistics) {
  Figures all{{"frames", statistics.frames}, {"cycles", statistics.cycles}};
  for (const std::uint64_t cycles : statistics.frame_cycles) all[frame_key(all.size() - 2)] = cycles;
  for (const platform::PortStatistics& port : statistics.ports) {
    all[port.name + " granted"] = port.grants;
    all[port.name + " stalled"] = port.stall_cycles;
    all[port.name + " passed"] = port.passed_cycles;
    all[port.name + " idle"] = port.idle_cycles;
    all[port.name + " blocked"] = port.blocked_cycles;
    all[port.name + " starved"] = port.starved_cycles;
  }
  for (const platform::BankStatistics& bank : statistics.banks) {
    all[bank.name + " reads"] = bank.reads;
    all[bank.name + " writes"] = bank.writes;
    all[bank.name + " busy"] = bank.busy_cycles;
    all[bank.name + " turnaround"] = bank.turnaround_cycles;
    all[bank.name + " row"] = bank.row_cycles.value_or(0);
    all[bank.name + " refresh"] = bank.refresh_cycles.value_or(0);
    all[bank.name + " idle"] = bank.idle_cycles;
    all[bank.name + " contended"] = bank.contended_cycles;
  }
  for (const platform::BlameRow& row : statistics.blame)
    all[blame_key(row.port, row.bank, row.by)] = row.cycles;
  return all;
}

Figures figures(const PlainCycleResult& result) {
  Figures all{{"frames", result.frame_cycles.size()}, {"cycles", result.counted_cycles}};
  for (const std::uint64_t cycles : result.frame_cycles) all[frame_key(all.size() - 2)] = cycles;
  for (std::size_t index = 0; index < result.ports.size(); ++index) {
    const PlainPortStates& port = result.ports[index];
    const std::string& name = result.names[index];
    all[name + " granted"] = port.granted;
    all[name + " stalled"] = port.stalled;
    all[name + " passed"] = port.passed;
    all[name + " idle"] = port.idle;
    all[name + " blocked"] = port.blocked;
    all[name + " starved"] = port.starved;
  }
  for (std::size_t index = 0; index < result.banks.size(); ++index) {
    const PlainBankStates& bank = result.banks[index];
    const std::string name = "bank" + std::to_string(index);
    all[name + " reads"] = bank.reads;
    all[name + " writes"] = bank.writes;
    all[name + " busy"] = bank.busy;
    all[name + " turnaround"] = bank.turnaround;
    all[name + " row"] = bank.row;
    all[name + " refresh"] = bank.refresh;
    all[name + " idle"] = bank.idle;
    all[name + " contended"] = bank.contended;
  }
  for (const auto& [row, cycles] : result.blame) {
    all[blame_key(result.names[row.port], "bank" + std::to_string(row.bank), result.names[row.by])] = cycles;
  }
  return all;
}

std::string differences(const Figures& model, const Figures& expected) {
  std::string text;
  const auto value = [](const Figures& all, const std::string& name) {
    const auto found = all.find(name);
    return found == all.end() ? std::string("absent") : std::to_string(found->second);
  };
  Figures names = model;
  names.insert(expected.begin(), expected.end());
  for (const auto& [name, unused] : names) {
    const std::string got = value(model, name);
    const std::string wanted = value(expected, name);
    if (got != wanted) text += name + " = " + got + ", expected " + wanted + "\n";
  }
  return text;
}

}  // namespace stereotlm::test
