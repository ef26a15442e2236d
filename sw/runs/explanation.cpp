#include "sw/runs/explanation.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <thread>
#include <utility>

#include "sw/process/installation.h"
#include "sw/process/interrupt.h"
#include "sw/runs/progress.h"

namespace stereotlm::runs {
namespace {

std::optional<std::string> joint_problem(const platform::Tables& tables) {
  return tables.left && tables.right ? platform::joint_tables_problem(tables) : std::nullopt;
}

}  // namespace

Explanation::Explanation(const platform::BoardConfig& board, const platform::Tables& tables, bool camera)
    : board_(board),
      tables_(tables),
      run_{camera, 0, ""},
      knobs_(explore::knob_steps(board, camera, joint_problem(tables))),
      points_(boards(), run_) {}

bool Explanation::simulate(PointSimulator simulator) {
  ProgressLine progress;
  return batch_.run(
      points_, [&simulator](const explore::Point& point) { return simulator(point); }, process::kVersion,
      std::max(1U, std::thread::hardware_concurrency()),
      [&](const explore::SweepCounts& done) {
        progress.show([&](double) { return fmt::format("{}/{} boards simulated", done.done(), done.total); });
        return !process::interrupted();
      });
}

std::vector<platform::BoardConfig> Explanation::boards() const {
  std::vector<platform::BoardConfig> all = {board_};
  for (const explore::KnobStep& step : knobs_.possible) all.push_back(step.board);
  return all;
}

Explanation::Rate Explanation::rate_of(std::uint64_t number) {
  try {
    const explore::StoredRow& row = batch_.row_of(points_.point(number));
    const auto lost =
        row.integer("cameras.left.dropped_pixels") + row.integer("cameras.right.dropped_pixels");
    return {row.real(run_.camera ? "frames_per_second.steady" : "frames_per_second.core"), lost > 0, ""};
  } catch (const explore::PointFailed& failed) {
    return {0, false, failed.what()};
  }
}

Explanation::Rate Explanation::now() {
  Rate rate = rate_of(0);
  if (!rate.failure.empty()) throw std::runtime_error(rate.failure);
  return rate;
}

Explanation::BusiestBank Explanation::busiest_bank_of(std::uint64_t number,
                                                      const platform::BoardConfig& board) {
  const explore::StoredRow& row = batch_.row_of(points_.point(number));
  BusiestBank busiest;
  std::int64_t most = -1;
  for (const platform::BankConfig& bank : board.banks) {
    const std::string path = "banks." + bank.name;
    const std::int64_t busy = row.integer(path + ".busy_cycles");
    if (busy <= most) continue;
    most = busy;
    const std::int64_t reads = row.integer(path + ".reads");
    const std::int64_t writes = row.integer(path + ".writes");
    const bool separate = memory::has_separate_ports(bank.kind);
    const std::int64_t accesses = separate ? std::max(reads, writes) : reads + writes;
    busiest = {bank.name, static_cast<double>(accesses) / static_cast<double>(row.integer("frames"))};
  }
  return busiest;
}

Explanation::BusiestBank Explanation::busiest_bank() { return busiest_bank_of(0, board_); }

std::vector<Explanation::Step> Explanation::steps() {
  std::vector<Step> all;
  for (std::size_t i = 0; i < knobs_.possible.size(); ++i) {
    const explore::KnobStep& knob = knobs_.possible[i];
    Step step{&knob, rate_of(i + 1), {}};
    if (step.rate.failure.empty()) step.busiest = busiest_bank_of(i + 1, knob.board);
    all.push_back(std::move(step));
  }
  std::stable_sort(all.begin(), all.end(), [](const Step& a, const Step& b) {
    if (a.rate.failure.empty() != b.rate.failure.empty()) return a.rate.failure.empty();
    return a.rate.frames_per_second > b.rate.frames_per_second;
  });
  return all;
}

std::vector<Explanation::Resource> Explanation::resources() {
  const Rate base = now();
  const auto frame_cycles = nlohmann::json::parse(figures().text("frame_cycles")).get<std::vector<double>>();
  const double mean = std::accumulate(frame_cycles.begin(), frame_cycles.end(), 0.0) /
                      static_cast<double>(frame_cycles.size());
  const double clock_hz = board_.fpga.clock_mhz * 1e6;
  const double stretch = clock_hz / mean / base.frames_per_second;
  std::vector<Resource> all;
  const auto add = [&all](const Resource& found) {
    const auto known =
        std::find_if(all.begin(), all.end(), [&](const auto& other) { return other.name == found.name; });
    if (known == all.end()) {
      all.push_back(found);
    } else if (found.headroom_percent != known->headroom_percent) {
      if (found.headroom_percent < known->headroom_percent) *known = found;
      known->varies = true;
    }
  };
  const std::uint64_t turn = platform::allocation_period_frames(board_);
  for (std::uint64_t frame = 0; frame < std::min<std::uint64_t>(turn, frame_cycles.size()); ++frame) {
    for (const platform::ResourceBound& bound : platform::frame_bounds(board_, tables_, frame)) {
      const auto cycles = static_cast<double>(bound.cycles);
      add({bound.resource, clock_hz / cycles, 100 * (1 - cycles / (stretch * frame_cycles[frame])), frame});
    }
  }
  if (run_.camera) {
    for (const platform::RateBound& part : platform::computer_bounds(board_, !base.loses_pixels)) {
      add({part.resource, part.frames_per_second, 100 * (1 - base.frames_per_second / part.frames_per_second),
           0});
    }
  }
  std::stable_sort(all.begin(), all.end(), [](const Resource& a, const Resource& b) {
    return a.headroom_percent < b.headroom_percent;
  });
  return all;
}

std::vector<explore::StoredBlame> Explanation::blames() {
  explore::Database store(batch_.path(), explore::Database::Access::kRead);
  explore::Statement find(
      store, "SELECT port, bank, by, cycles FROM blame WHERE hash = ? ORDER BY cycles DESC, port, bank, by");
  find.bind(1, points_.point(0).hash);
  std::vector<explore::StoredBlame> all;
  while (find.step()) all.push_back({find.text(0), find.text(1), find.text(2), find.integer(3)});
  return all;
}

}  // namespace stereotlm::runs
