#include "sw/runs/explanation.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <set>
#include <stdexcept>
#include <thread>
#include <utility>

#include "models/fpga/frame_geometry.h"
#include "platform/figures.h"
#include "sw/process/installation.h"
#include "sw/process/interrupt.h"
#include "sw/runs/progress.h"
#include "sw/runs/waitless_core.h"

namespace stereotlm::runs {
namespace {

// A rate that is below its bound by less than this share is that of the bound.
constexpr double kAtBound = 0.005;

std::optional<std::string> joint_problem(const platform::Tables& tables) {
  return tables.left && tables.right ? platform::joint_tables_problem(tables) : std::nullopt;
}

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

}  // namespace

Explanation::Explanation(const platform::BoardConfig& board, const platform::Tables& tables, bool camera,
                         std::uint64_t frames)
    : board_(board),
      tables_(tables),
      run_{camera,
           frames > 0 ? frames
           : camera   ? kComputerFrames
                      : kCoreFrames,
           ""},
      knobs_(explore::knob_steps(board, camera, joint_problem(tables))),
      points_(explore::board_points(boards(), run_)),
      accesses_(platform::frame_accesses(board, tables)) {
  const std::uint64_t turn = platform::allocation_period_frames(board);
  for (std::uint64_t frame = 0; frame < turn; ++frame)
    bounds_.push_back(platform::frame_bounds(board, accesses_, frame));
}

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
    if (!run_.camera) return {row.real("frames_per_second.core"), 0, false, ""};
    const auto lost =
        row.integer("cameras.left.dropped_pixels") + row.integer("cameras.right.dropped_pixels");
    return {row.real("frames_per_second.steady"), row.real("frames_per_second.steady_uncertainty"), lost > 0,
            ""};
  } catch (const explore::PointFailed& failed) {
    return {0, 0, false, failed.what()};
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
  std::set<std::string> groups;
  std::set<std::string> whole;  // groups with an alternative that loses no pixels
  for (const Step& step : all) {
    if (step.rate.failure.empty() && !step.rate.loses_pixels) whole.insert(step.step->group);
  }
  const auto is_alternative = [&](const Step& step) {
    const std::string& group = step.step->group;
    if (group.empty() || !step.rate.failure.empty()) return false;
    return (step.rate.loses_pixels && whole.count(group) > 0) || !groups.insert(group).second;
  };
  all.erase(std::remove_if(all.begin(), all.end(), is_alternative), all.end());
  return all;
}

std::vector<double> Explanation::frame_cycles() {
  return nlohmann::json::parse(figures().text("frame_cycles")).get<std::vector<double>>();
}

double Explanation::busy_percent(const std::string& resource) {
  const explore::StoredRow& row = figures();
  const auto number = [&row](const std::string& path) { return static_cast<double>(row.integer(path)); };
  const std::size_t space = resource.find(' ');
  const std::string name = space == std::string::npos ? "" : resource.substr(space + 1);
  if (resource == "camera")
    return 100 * number("cameras.left.captured_frames") / number("cameras.left.frames");
  if (resource == "pci") return 100 * number("pci.busy_clocks") / number("pci.clocks");
  if (resource == "bridge") return 100 * number("bridge.local_busy_clocks") / number("bridge.local_clocks");
  if (resource == "matcher") {
    const fpga::FrameGeometry geometry(platform::core_config(board_));
    const auto of_frame = static_cast<double>((geometry.slots + geometry.drain_cycles) *
                                              static_cast<unsigned>(geometry.passes));
    return 100 * number("frames") * of_frame / number("cycles");
  }
  if (const auto bank = platform::bank_of_resource(resource))
    return 100 * number("banks." + *bank + ".busy_cycles") / number("cycles");
  const std::string port = "ports." + name;
  return 100 * (number(port + ".grants") + number(port + ".passed_cycles")) / number("cycles");
}

std::vector<Explanation::Resource> Explanation::resources() {
  const Rate base = now();
  const std::vector<double> cycles = frame_cycles();
  const double mean = mean_of(cycles);
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
  for (std::size_t frame = 0; frame < std::min(bounds_.size(), cycles.size()); ++frame) {
    for (const platform::ResourceBound& bound : bounds_[frame]) {
      if (run_.camera && platform::bank_of_resource(bound.resource))
        continue;  // below, with the accesses of the host
      const auto needed = static_cast<double>(bound.cycles);
      add({bound.resource, clock_hz / needed, 100 * (1 - needed / (stretch * cycles[frame])),
           busy_percent(bound.resource), frame});
    }
  }
  if (run_.camera) {
    for (const platform::RateBound& part : platform::computer_bounds(board_, accesses_, !base.loses_pixels)) {
      add({part.resource, part.frames_per_second, 100 * (1 - base.frames_per_second / part.frames_per_second),
           busy_percent(part.resource), 0});
    }
  }
  std::stable_sort(all.begin(), all.end(), [](const Resource& a, const Resource& b) {
    return a.headroom_percent < b.headroom_percent;
  });
  return all;
}

const Explanation::Budget& Explanation::budget() {
  if (budget_) return *budget_;
  budget_.emplace();
  double frames_share = 100;
  if (run_.camera) {
    for (const auto& [why, share] : core_time(board_, tables_, run_.frames)) {
      if (why.empty()) {
        frames_share = 100 * share;
      } else {
        budget_->core_waits[why] = 100 * share;
      }
    }
  }
  const std::uint64_t turn = bounds_.size();
  std::vector<double> cycles = frame_cycles();
  if (run_.camera) {
    const std::uint64_t window = platform::steady_frames(run_.frames, turn);
    cycles.erase(cycles.begin(), cycles.end() - static_cast<std::ptrdiff_t>(window));
  }
  const double mean = mean_of(cycles);
  double needed = 0;  // by matcher and ports
  for (const std::vector<platform::ResourceBound>& of_frame : bounds_) {
    double most = 0;
    for (const platform::ResourceBound& bound : of_frame) {
      if (!platform::bank_of_resource(bound.resource))
        most = std::max(most, static_cast<double>(bound.cycles));
    }
    needed += most / static_cast<double>(turn);
  }
  const double waitless = board_.fpga.clock_mhz * 1e6 / waitless_frames_per_second(board_, tables_, turn);
  budget_->bound = frames_share * needed / mean;
  budget_->queues = frames_share * (waitless - needed) / mean;
  budget_->waits = frames_share * (mean - waitless) / mean;
  return *budget_;
}

Explanation::Limiter Explanation::limiter() {
  const Rate rate = now();
  if (rate.loses_pixels) return Limiter::kLostPixels;
  const double bound = figures().real(run_.camera ? "bound.system" : "bound.core");
  if (rate.frames_per_second >= bound * (1 - kAtBound)) return Limiter::kBound;
  double core_waits = 0;
  for (const auto& [why, share] : budget().core_waits) core_waits += share;
  const double others = std::max(budget().queues, 0.0);
  if (budget().waits > std::max(core_waits, others)) return Limiter::kWaits;
  return core_waits > others ? Limiter::kCoreWaits : Limiter::kQueues;
}

std::vector<explore::StoredBlame> Explanation::blames() {
  sqlite::Database store(batch_.path(), sqlite::Database::Access::kRead);
  sqlite::Statement find(
      store, "SELECT port, bank, by, cycles FROM blame WHERE hash = ? ORDER BY cycles DESC, port, bank, by");
  find.bind(1, points_.point(0).hash);
  std::vector<explore::StoredBlame> all;
  while (find.step()) all.push_back({find.text(0), find.text(1), find.text(2), find.integer(3)});
  return all;
}

}  // namespace stereotlm::runs
