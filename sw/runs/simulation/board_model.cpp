#include "sw/runs/simulation/board_model.h"

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "platform/figures/derived_figures.h"
#include "platform/figures/proven_rate.h"
#include "platform/figures/search_bounds.h"
#include "platform/loop/core_loop.h"
#include "sw/explore/optimise/key_effects.h"
#include "sw/runs/simulation/simulate_point.h"

namespace stereotlm::runs {
namespace {

using platform::BoardConfig;

// What the slots of boards access. That of the last board is kept, because the next one is mostly like it.
class AccessesOfBoards {
 public:
  explicit AccessesOfBoards(const platform::Tables* tables) : tables_(tables) {}

  const fpga::AccessPatterns& patterns(const BoardConfig& board) {
    std::string key = explore::waitless_key(board);
    for (const platform::BankConfig& bank : board.banks) key += bank.sdram ? 's' : '-';
    if (key == key_) return *patterns_;
    key_ = std::move(key);
    patterns_ = platform::access_patterns(board, tables_);
    accesses_.reset();
    return *patterns_;
  }
  const platform::FrameAccesses& accesses(const BoardConfig& board) {
    patterns(board);
    if (!accesses_) accesses_ = platform::frame_accesses(board, *patterns_);
    return *accesses_;
  }

 private:
  const platform::Tables* tables_;
  std::string key_;
  std::optional<fpga::AccessPatterns> patterns_;
  std::optional<platform::FrameAccesses> accesses_;
};

// The figures of a run of the core alone that follow from its cycles, as collect_statistics() has them.
std::map<std::string, double> figures_of_cycles(const BoardConfig& board, std::uint64_t frames,
                                                std::uint64_t all_cycles,
                                                const platform::FrameAccesses* accesses) {
  const std::uint64_t cycles =
      all_cycles - frames * static_cast<std::uint64_t>(board.fpga.pipeline_latency_cycles);
  std::map<std::string, double> figures = {
      {"cycles", static_cast<double>(cycles)},
      {"frames_per_second.core",
       board.fpga.clock_mhz * 1e6 * static_cast<double>(frames) / static_cast<double>(all_cycles)}};
  if (accesses == nullptr) return figures;
  platform::Statistics statistics;
  statistics.frames = frames;
  statistics.cycles = cycles;
  statistics.banks = platform::accesses_of_banks(board, *accesses, frames);
  statistics.ports.resize(core_ports(board).size());
  derive_energy(board, statistics);
  figures["energy.memory_mj_per_frame"] = statistics.energy.memory_mj_per_frame;
  return figures;
}

}  // namespace

explore::BoardModel board_model(const platform::Tables* tables, PointQuality quality) {
  const auto all = std::make_shared<AccessesOfBoards>(tables);
  const auto simulator =
      std::make_shared<PointSimulator>(tables == nullptr ? PointSimulator() : PointSimulator(*tables));
  explore::BoardModel model;
  model.waitless_cycles = [all](const BoardConfig& board) {
    return platform::waitless_frame_cycles(board, all->patterns(board), 1).front();
  };
  model.contended_cycles = [all](const BoardConfig& board) {
    return platform::least_frame_cycles(board, all->accesses(board), 0);
  };
  model.frame_cycles = [all](const BoardConfig& board, std::uint64_t frames) {
    return platform::core_frame_cycles(board, all->patterns(board), frames);
  };
  model.figures_of_cycles = [all](const BoardConfig& board, std::uint64_t frames, std::uint64_t cycles,
                                  bool has_energy) {
    return figures_of_cycles(board, frames, cycles, has_energy ? &all->accesses(board) : nullptr);
  };
  model.long_run_rate = [all](const BoardConfig& board, const std::vector<std::uint64_t>& frame_cycles) {
    const double bound = platform::steady_bound(board, all->accesses(board));
    const auto proven = platform::proven_rate(board, all->accesses(board), frame_cycles, bound);
    return proven ? explore::Range{proven->least, proven->most} : explore::Range{0, bound};
  };
  model.simulate = [simulator](const explore::Point& point) { return (*simulator)(point); };
  if (!quality.has_pictures()) return model;
  model.accuracy = [judge = std::make_shared<PointQuality>(std::move(quality)),
                    tables](const BoardConfig& board) {
    const stats::Accuracy its = *judge->of(board, tables);
    std::map<std::string, double> figures;
    const std::array values = {its.bad_1_percent, its.bad_2_percent, its.answered_percent};
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (values[i]) figures.emplace(explore::accuracy_figures()[i], *values[i]);
    }
    return figures;
  };
  return model;
}

}  // namespace stereotlm::runs
