#include "sw/runs/explanation.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>
#include <stdexcept>
#include <thread>
#include <tuple>
#include <utility>
#include <variant>

#include "models/capture/camera_timing.h"
#include "models/fpga/core_ports.h"
#include "models/fpga/frame_geometry.h"
#include "platform/config/board_area.h"
#include "platform/config/buffer_layout.h"
#include "platform/figures/derived_figures.h"
#include "platform/figures/proven_rate.h"
#include "platform/loop/core_loop.h"
#include "sw/explore/optimise/key_effects.h"
#include "sw/explore/optimise/workers.h"
#include "sw/files/text_forms.h"
#include "sw/process/streams.h"
#include "sw/runs/progress.h"
#include "sw/stats/console_table.h"
#include "sw/stats/stats_json.h"

namespace stereotlm::runs {
namespace {

using Json = nlohmann::ordered_json;

// A rate that is below its bound by less than this share is that of the bound. So is one that is below it by
// less than its uncertainty, unless that is larger than kMostOpen of the bound.
constexpr double kAtBound = 0.005;
constexpr double kMostOpen = 0.05;

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

const std::string kHost = fpga::kPortGroups[fpga::kHostGroup].name;
const std::string kResult = fpga::kPortGroups[fpga::kResultGroup].name;
constexpr double kVisibleLoss = 0.01;     // of the cycles
constexpr double kVisiblePercent = 0.05;  // of the time of a frame
constexpr double kLeastHeadroom = 10;     // of a bus in percent; with less it is named beside what waits

struct Reason {
  const char* why;      // of the time line
  const char* limiter;  // whom the core waits for
  const char* text;
};
constexpr std::array<Reason, 6> kReasons = {
    Reason{"upload", "the upload of the tables", "the tables"},
    Reason{"camera", "the captures", "a camera frame to begin"},
    Reason{"capture", "the captures", "the end of a capture"},
    Reason{"copy", "the copies from host memory", "the end of a copy from host memory"},
    Reason{"output_buffer", "the read-back", "a result to be read back"},
    Reason{"host", "the driver", "register accesses"}};

const Reason& reason_of(const std::string& why) {
  for (const Reason& reason : kReasons) {
    if (reason.why == why) return reason;
  }
  throw std::logic_error(why + ": not a reason for which the core waits");
}

std::string reason_text(const Explanation& explanation, const std::string& why) {
  const bool is_clocked =
      why == "capture" && explanation.board().cameras.trigger == platform::CameraTrigger::kFreeRunning;
  return reason_of(why).text + std::string(is_clocked ? ", which begins only with a camera frame" : "");
}

// "left_lut waits there for left_pixel in 33.14 % of the cycles"
std::string wait_of(const Explanation& explanation, const platform::BlameRow& wait) {
  return fmt::format("{} waits there for {} in {:.2f} % of the cycles", wait.port, stats::cause_text(wait.by),
                     explanation.percent_of_cycles(wait.cycles));
}

// The PCI bus or the local bus, where it has little headroom.
std::string busy_bus_text(const Explanation& explanation) {
  std::string text;
  for (const Explanation::Resource& resource : explanation.resources()) {
    if ((resource.name == "pci" || resource.name == "bridge") && resource.headroom_percent < kLeastHeadroom)
      text += fmt::format("; {} is busy in {:.1f} % of its clocks", stats::resource_words(resource.name),
                          resource.busy_percent);
  }
  return text;
}

// A frame rate at the bound of its limiter.
std::string bound_text(const Explanation& explanation, const std::string& owner, double bound) {
  const double rate = explanation.now().frames_per_second;
  const bool is_open = rate < bound * (1 - kAtBound) || rate - bound >= stats::kVisibleRate;
  const std::string text = fmt::format("{}, at the bound of {:.3f} frames/s{}", stats::resource_words(owner),
                                       bound, is_open ? " within the uncertainty" : "");
  const auto wait = longest_wait(explanation, owner);
  return wait ? text + "; " + wait_of(explanation, *wait) : text;
}

// Why captures lose pixels. First what is certain: a bus needs longer for a pair of pictures than the pair
// takes to arrive, or cannot move whole pictures at this rate.
std::string lost_pixels_text(const Explanation& explanation) {
  const NamedFigures& row = explanation.figures();
  const std::int64_t lost = explanation.now().lost_pixels;
  const std::string text =
      fmt::format(": captures lose {} pixel{} while {} frames are delivered, so pictures are torn", lost,
                  lost == 1 ? "" : "s", explanation.frames());
  const double arrival_s = explanation.picture_seconds();
  const auto slowest = std::max_element(explanation.pair_seconds().begin(), explanation.pair_seconds().end(),
                                        [](const auto& a, const auto& b) { return a.second < b.second; });
  if (slowest->second > arrival_s) {
    return fmt::format("{}{}; a pair of pictures arrives in {:.3f} ms, and takes {:.3f} ms there",
                       stats::resource_words(slowest->first), text, 1e3 * arrival_s, 1e3 * slowest->second);
  }
  if (const Explanation::Resource& least = explanation.resources().front(); least.headroom_percent < 0) {
    return fmt::format("{}{}; whole pictures at this rate need {:.2f} times its time",
                       stats::resource_words(least.name), text, 1 - least.headroom_percent / 100);
  }
  // Else a bus that is nearly always busy. Else the FIFOs are too short for the waits.
  const std::vector<Explanation::Resource>& all = explanation.resources();
  const auto busy_of = [&all](const char* name) {
    return std::find_if(all.begin(), all.end(), [name](const auto& each) { return each.name == name; })
        ->busy_percent;
  };
  const char* const bus = busy_of("pci") >= busy_of("bridge") ? "pci" : "bridge";
  double clocks = 0;  // that a capture board waits for a burst, on average
  for (const std::string master : {"pci.masters.left_capture", "pci.masters.right_capture"}) {
    const auto bursts = std::max<std::int64_t>(1, row.integer(master + ".transactions"));
    clocks = std::max(
        clocks, static_cast<double>(row.integer(master + ".wait_clocks")) / static_cast<double>(bursts));
  }
  std::string where;
  for (const platform::BlameRow& wait : explanation.blames()) {
    if (wait.port != kHost || explanation.percent_of_cycles(wait.cycles) < 100 * kVisibleLoss) continue;
    where = fmt::format("; {}: {}", platform::bank_text(wait.bank), wait_of(explanation, wait));
    break;
  }
  const platform::CaptureConfig& capture = explanation.board().capture;
  const std::string limiter =
      busy_of(bus) > 100 - kLeastHeadroom
          ? stats::resource_words(bus)
          : fmt::format("the FIFOs of the capture boards, which hold {} words and request the bus at {}",
                        capture.fifo_words, capture.fifo_trigger_words);
  return fmt::format(
      "{}{}; {} is busy in {:.1f} % of its clocks, and a capture board waits {:.1f} PCI clocks "
      "for a burst{}",
      limiter, text, stats::resource_words(bus), busy_of(bus), clocks, where);
}

std::string waits_text(const Explanation& explanation) {
  const std::string cost = fmt::format("all waits cost {:.2f} % of the time", explanation.budget().waits);
  const auto wait = longest_wait(explanation);
  return wait ? fmt::format("waits at {}: {}; {}", platform::bank_text(wait->bank),
                            wait_of(explanation, *wait), cost)
              : "waits for banks: " + cost;
}

// The share of the cycles in which the matcher waits because the result queue is too short, in percent; 0 if
// it does not limit the board.
double result_queue_percent(const Explanation& explanation) {
  const NamedFigures& row = explanation.figures();
  const double cycles = static_cast<double>(row.integer("cycles"));
  const double lost = cycles * (1 - row.real("frames_per_second.core") / row.real("bound.core"));
  std::int64_t stalled = 0;
  std::int64_t blocked = 0;
  const fpga::CorePorts ports = platform::core_ports(explanation.board());
  for (memory::Port port = 0; port < ports.size(); ++port) {
    const std::string name = "ports." + ports.name(port);
    stalled += row.integer(name + ".stall_cycles");
    blocked = std::max(blocked, row.integer(name + ".blocked_cycles"));
  }
  const bool is_too_short = row.text("bound.core_limited_by") == "matcher" && lost > kVisibleLoss * cycles &&
                            stalled == 0 && static_cast<double>(blocked) > lost / 2;
  return is_too_short ? 100 * lost / cycles : 0;
}

std::string queues_text(const Explanation& explanation) {
  const double percent = result_queue_percent(explanation);
  if (percent > 0) {
    return fmt::format(
        "the result queue, which is too short: in {:.2f} % of the cycles the matcher waits for a place in it "
        "(fpga.result_fifo_words)",
        percent);
  }
  return fmt::format("the queues of the core and the latencies of its banks, which cost {:.2f} % of the time",
                     files::without_minus_zero(explanation.budget().queues, 2));
}

std::string core_waits_text(const Explanation& explanation) {
  double sum = 0;
  std::vector<std::pair<double, std::string>> shares;
  for (const auto& [why, share] : explanation.budget().core_waits) {
    sum += share;
    shares.emplace_back(share, why);
  }
  std::sort(shares.rbegin(), shares.rend());
  const bool is_one = shares.size() == 1 || shares[1].first < kVisiblePercent;
  std::string text =
      fmt::format("{}: the core waits {:.2f} % of the time", reason_of(shares.front().second).limiter,
                  is_one ? shares.front().first : sum);
  if (is_one) text += fmt::format(" for {}", reason_text(explanation, shares.front().second));
  const char* separator = ", ";
  for (const auto& [share, why] : shares) {
    if (is_one || share < kVisiblePercent) break;
    text += fmt::format("{}{:.2f} % for {}", separator, share, reason_text(explanation, why));
    separator = " and ";
  }
  return text + busy_bus_text(explanation);
}

// What limits the rate, whether pixels are lost or not.
std::string rate_limiter_text(const Explanation& explanation) {
  const platform::RateBound& bound = explanation.rate_bound();
  const Explanation::Rate& now = explanation.now();
  const double open = std::min(now.uncertainty, kMostOpen * bound.frames_per_second);
  if (now.frames_per_second >= bound.frames_per_second - std::max(open, kAtBound * bound.frames_per_second))
    return bound_text(explanation, bound.resource, bound.frames_per_second);
  const Budget& budget = explanation.budget();
  double core_waits = 0;
  for (const auto& [why, share] : budget.core_waits) core_waits += share;
  const double queues = std::max(budget.queues, 0.0);
  if (budget.waits > std::max(core_waits, queues)) return waits_text(explanation);
  return core_waits > queues ? core_waits_text(explanation) : queues_text(explanation);
}

// Blames of ports as those of port groups, the most cycles first. Of a group they are the mean of its lanes.
std::vector<platform::BlameRow> by_group(const std::vector<platform::BlameRow>& blames, std::uint64_t lanes) {
  std::vector<platform::BlameRow> all;
  for (const platform::BlameRow& blame : blames) {
    const platform::BlameRow of_group = {stats::group_text(blame.port), blame.bank,
                                         stats::group_text(blame.by), 0};
    auto row = std::find_if(all.begin(), all.end(), [&](const platform::BlameRow& each) {
      return each.port == of_group.port && each.bank == of_group.bank && each.by == of_group.by;
    });
    if (row == all.end()) row = all.insert(all.end(), of_group);
    row->cycles += blame.cycles;
  }
  for (platform::BlameRow& row : all) {
    if (row.port != kHost && row.port != kResult) row.cycles /= lanes;
  }
  std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.cycles > b.cycles; });
  return all;
}

Json resources_json(const Explanation& explanation) {
  Json all = Json::array();
  for (const Explanation::Resource& resource : explanation.resources()) {
    Json row = {{"resource", resource.name},
                {"frames_per_second", resource.frames_per_second},
                {"headroom_percent", resource.headroom_percent},
                {"busy_percent", resource.busy_percent}};
    if (resource.varies) row["frame"] = resource.frame;
    all.push_back(std::move(row));
  }
  return all;
}

Json blame_json(const Explanation& explanation) {
  Json all = Json::array();
  for (const platform::BlameRow& blame : explanation.blames()) {
    all.push_back({{"port", blame.port},
                   {"bank", blame.bank},
                   {"by", blame.by},
                   {"cycles", blame.cycles},
                   {"cycles_percent", explanation.percent_of_cycles(blame.cycles)}});
  }
  return all;
}

Json change_json(const explore::KnobStep& step) {
  return {{"key", step.knob}, {"from", step.from}, {"to", step.to}};
}

// Adds `changes`, the best first, `failed` and `impossible`.
void add_changes(const Explanation& explanation, Json& document) {
  const double now = explanation.now().frames_per_second;
  Json changes = Json::array();
  Json failed = Json::array();
  for (const Explanation::Step& found : explanation.steps()) {
    const explore::KnobStep& step = *found.step;
    Json change = change_json(step);
    if (!found.rate.failure.empty()) {
      change["reason"] = found.rate.failure;
      failed.push_back(std::move(change));
      continue;
    }
    const double rate = found.rate.frames_per_second;
    change["frames_per_second"] = rate;
    change["gained_frames_per_second"] = rate - now;
    change["gained_percent"] = explanation.gained_percent(found);
    change["memory_mj_per_frame"] = found.rate.memory_mj;
    change["memory_mj_changed_percent"] = explanation.energy_percent(found);
    change["changes_disparities"] = step.changes_disparities;
    change["loses_pixels"] = found.rate.loses_pixels();
    change["sets"] = step.sets;
    change["area"] = stats::area_json(step.board);
    change["pins"] = platform::pins_of(step.board);
    changes.push_back(std::move(change));
  }
  document["changes"] = std::move(changes);
  Json& impossible = document["impossible"] = Json::array();
  for (const explore::KnobStep& step : explanation.knobs().forbidden) {
    impossible.push_back(change_json(step));
    impossible.back()["reason"] = step.reason;
  }
  document["failed"] = std::move(failed);
}

// A message between processes: the figures of a board, or why it has none.
std::string message_of(const Json& document) {
  const auto bytes = Json::to_cbor(document);
  return {bytes.begin(), bytes.end()};
}

Json json_of(const explore::Figures& figures) {
  Json values = Json::array();
  for (const platform::BoardValue& value : figures.values)
    std::visit([&](const auto& its) { values.push_back({value.path, its}); }, value.value);
  Json blame = Json::array();
  for (const platform::BlameRow& row : figures.blame)
    blame.push_back({row.port, row.bank, row.by, row.cycles});
  return {{"values", std::move(values)}, {"blame", std::move(blame)}};
}

explore::Figures figures_of(const Json& document) {
  explore::Figures figures;
  for (const Json& pair : document["values"]) {
    const Json& value = pair[1];
    figures.values.push_back({pair[0], value.is_string() ? platform::KeyValue(value.get<std::string>())
                                       : value.is_number_integer()
                                           ? platform::KeyValue(value.get<std::int64_t>())
                                           : platform::KeyValue(value.get<double>())});
  }
  for (const Json& row : document["blame"]) figures.blame.push_back({row[0], row[1], row[2], row[3]});
  return figures;
}

}  // namespace

NamedFigures::NamedFigures(const explore::Figures& figures) {
  for (const platform::BoardValue& value : figures.values) values_.emplace(value.path, value.value);
}

std::string NamedFigures::text(const std::string& name) const {
  const auto found = values_.find(name);
  return found == values_.end() ? "" : platform::value_text(found->second);
}

std::int64_t NamedFigures::integer(const std::string& name) const {
  const auto found = values_.find(name);
  return found == values_.end() ? 0 : std::get<std::int64_t>(found->second);
}

double NamedFigures::real(const std::string& name) const {
  const auto found = values_.find(name);
  if (found == values_.end()) return 0;
  const auto* const integer = std::get_if<std::int64_t>(&found->second);
  return integer != nullptr ? static_cast<double>(*integer) : std::get<double>(found->second);
}

Explanation::Explanation(const platform::BoardConfig& board, const platform::Tables& tables, bool camera,
                         std::uint64_t frames)
    : board_(board),
      tables_(tables),
      run_{camera,
           frames > 0 ? frames
           : camera   ? kComputerFrames
                      : kCoreFrames,
           ""},
      knobs_(explore::knob_steps(
          board, camera,
          tables.left && tables.right ? platform::joint_tables_problem(tables) : std::nullopt)),
      outcomes_(1 + knobs_.possible.size()),
      proven_(outcomes_.size()),
      accesses_(platform::frame_accesses(board, tables)) {
  const std::uint64_t turn = platform::allocation_period_frames(board);
  for (std::uint64_t frame = 0; frame < turn; ++frame)
    bounds_.push_back(platform::frame_bounds(board, accesses_, frame));
}

const platform::BoardConfig& Explanation::board_of(std::size_t number) const {
  return number == 0 ? board_ : knobs_.possible.at(number - 1).board;
}

// Does this for each of these boards, in all processes. A board for which it throws has a failure.
template <typename Work, typename Take>
void Explanation::for_each(const std::vector<std::size_t>& numbers, const char* done_to_them,
                           ProgressLine& progress, const Work& work, const Take& take) const {
  const auto before = static_cast<std::size_t>(
      std::count_if(outcomes_.begin(), outcomes_.end(), [](const auto& its) { return its.has_value(); }));
  std::size_t done = 0;
  explore::do_in_processes(
      numbers.size(), std::max(1U, std::thread::hardware_concurrency()),
      [&](std::size_t place) {
        const platform::BoardConfig& board = board_of(numbers[place]);
        try {
          return message_of(work(numbers[place], board));
        } catch (const std::exception& error) {
          return message_of(Json{{"failure", fmt::format("{}: {}", board.name, error.what())}});
        }
      },
      [&](std::size_t place, const std::string& message) {
        ++done;
        take(numbers[place], Json::from_cbor(message));
      },
      [&] {
        const std::size_t of = before + numbers.size();
        progress.show(before + done, of, [&](double seconds) {
          return progress_text(before + done, of, fmt::format("boards {}", done_to_them), seconds);
        });
        return !process::interrupted();
      });
}

// What is proven of each computer. A core that is simulated cycle by cycle takes too long to ask.
void Explanation::prove(ProgressLine& progress) {
  std::vector<std::size_t> all(outcomes_.size());
  std::iota(all.begin(), all.end(), 0);
  const auto work = [this](std::size_t, const platform::BoardConfig& board) {
    const fpga::AccessPatterns patterns = platform::access_patterns(board, &tables_);
    const platform::FrameAccesses accesses = platform::frame_accesses(board, patterns);
    const std::uint64_t turn = platform::allocation_period_frames(board);
    double work_pj = 0;
    BusiestBank busiest;
    const auto of_banks = platform::accesses_of_banks(board, accesses, turn, true);
    for (std::size_t bank = 0; bank < of_banks.size(); ++bank) {
      const platform::BankConfig& its = board.banks[bank];
      const double reads = static_cast<double>(of_banks[bank].reads) / static_cast<double>(turn);
      const double writes = static_cast<double>(of_banks[bank].writes) / static_cast<double>(turn);
      work_pj += platform::energy_of(its).access_pj * (reads + writes);
      const double busy = memory::has_separate_ports(its.kind) ? std::max(reads, writes) : reads + writes;
      if (busiest.name.empty() || busy > busiest.accesses_per_frame) busiest = {its.name, busy};
    }
    Json proven = {{"work_pj", work_pj}, {"busiest", {busiest.name, busiest.accesses_per_frame}}};
    if (!stepped_text(board, tables_, false).empty()) return proven;
    const std::vector<std::uint64_t> cycles = platform::core_frame_cycles(board, patterns, turn);
    const auto rate = platform::proven_rate(board, accesses, cycles, platform::steady_bound(board, accesses));
    proven["rate"] = {rate->least, rate->most};
    if (platform::frames_are_apart(board, accesses))
      proven["time"] = explore::computer_time_key(board, cycles);
    return proven;
  };
  for_each(all, "examined", progress, work, [this](std::size_t number, const Json& its) {
    if (its.contains("failure")) return;  // that of its simulation is shown
    proven_[number].work_pj = its["work_pj"];
    proven_[number].busiest = {its["busiest"][0], its["busiest"][1]};
    proven_[number].time = its.value("time", "");
    if (its.contains("rate")) proven_[number].rate = {its["rate"][0], its["rate"][1]};
  });
}

void Explanation::simulate(const std::vector<std::size_t>& numbers, PointSimulator& simulator,
                           ProgressLine& progress) {
  // A rate that is proven needs no measurement. A turn of the lists shows whether pixels are lost.
  const auto is_short = [this](std::size_t number) {
    return run_.camera && number != 0 && proven_[number].rate.is_exact();
  };
  const auto work = [&](std::size_t number, const platform::BoardConfig& board) {
    explore::PointRun run = run_;
    if (is_short(number)) run.frames = kTurns;
    return json_of(simulator(explore::make_point(number, board, run), run_.camera && number == 0));
  };
  // Of computers that do the same at the same time, one is simulated.
  std::vector<std::size_t> firsts;
  std::map<std::size_t, std::size_t> like;  // the one that is simulated for another
  for (const std::size_t number : numbers) {
    const auto gives = [&](std::size_t other) {
      const bool is_simulated = outcomes_[other] ? outcomes_[other]->failure.empty()
                                                 : std::count(firsts.begin(), firsts.end(), other) > 0;
      return is_simulated && proven_[other].time == proven_[number].time &&
             (is_short(number) || !is_short(other));
    };
    std::size_t other = proven_[number].time.empty() ? outcomes_.size() : 0;
    while (other < outcomes_.size() && !gives(other)) ++other;
    if (other < outcomes_.size()) {
      like.emplace(number, other);
    } else {
      firsts.push_back(number);
    }
  }
  for_each(firsts, "simulated", progress, work, [&](std::size_t number, const Json& its) {
    if (its.contains("failure")) {
      outcomes_[number] = {{}, its["failure"]};
      return;
    }
    const explore::Figures figures = figures_of(its);
    const NamedFigures named(figures);
    if (is_short(number) && named.integer("lost_pixels") > 0) {
      proven_[number].rate = {};  // nothing is proven without whole pictures: it gets a long run
      return;
    }
    outcomes_[number] = {named, ""};
    if (number == 0) blames_ = figures.blame;
  });
  for (const auto& [number, other] : like) {
    if (!outcomes_[other] || !outcomes_[other]->failure.empty()) continue;
    outcomes_[number] = outcomes_[other];
    ++shared_;
  }
}

// The boards that are to be simulated next: the board, its steps and one of each group, whose rate is certain
// to be high, or else may be. Then those that may be better than that one, or all if it loses pixels: what is
// proven of a rate is of whole pictures.
std::vector<std::size_t> Explanation::next_boards() const {
  struct Group {
    std::size_t first = 0;
    bool is_begun = false;
    double best = -std::numeric_limits<double>::infinity();  // of those that lose no pixels
  };
  std::map<std::string, Group> groups;
  const auto group_of = [this](std::size_t number) {
    return number == 0 ? std::string() : knobs_.possible[number - 1].group;
  };
  for (std::size_t number = 0; number < outcomes_.size(); ++number) {
    Group& group = groups.emplace(group_of(number), Group{number}).first->second;
    const auto promise = [&](std::size_t one) {
      return std::pair(proven_[one].rate.least, proven_[one].rate.most);
    };
    if (promise(number) > promise(group.first)) group.first = number;
    if (!outcomes_[number]) continue;
    group.is_begun = true;
    const Rate rate = rate_of(number);
    if (rate.is_whole()) group.best = std::max(group.best, rate.frames_per_second + rate.uncertainty);
  }
  std::vector<std::size_t> numbers;
  for (std::size_t number = 0; number < outcomes_.size(); ++number) {
    const std::string name = group_of(number);
    const Group& group = groups[name];
    const double most = proven_[number].rate.most;
    const bool may_be_best = group.is_begun ? most > group.best : number == group.first || std::isinf(most);
    if (!outcomes_[number] && (name.empty() || may_be_best)) numbers.push_back(number);
  }
  return numbers;
}

bool Explanation::simulate(PointSimulator simulator) {
  ProgressLine progress(
      fmt::format("at most {} boards are simulated, for at most {} frames each", outcomes_.size(), frames()),
      stepped_text(board_, tables_, run_.camera));
  if (run_.camera) prove(progress);
  if (process::interrupted()) return false;
  for (auto numbers = next_boards(); !numbers.empty() && !process::interrupted(); numbers = next_boards())
    simulate(numbers, simulator, progress);
  if (!outcomes_[0]) return false;
  now_ = rate_of(0);
  if (!now_.failure.empty()) throw std::runtime_error(now_.failure);
  figures_ = outcomes_[0]->figures;
  busiest_ = busiest_bank_of(0);
  std::sort(blames_.begin(), blames_.end(), [](const platform::BlameRow& a, const platform::BlameRow& b) {
    return std::tie(b.cycles, a.port, a.bank, a.by) < std::tie(a.cycles, b.port, b.bank, b.by);
  });
  group_blames_ = by_group(blames_, static_cast<std::uint64_t>(board_.fpga.lanes));
  read_steps();
  const auto cycles = nlohmann::json::parse(figures_.text("frame_cycles")).get<std::vector<double>>();
  compare_resources(cycles);
  share_time(cycles);
  return true;
}

std::string Explanation::interruption() const {
  const std::size_t missing = next_boards().size();
  if (missing == 0) return "";
  return fmt::format("{} of {} changes were evaluated", evaluated_, evaluated_ + missing);
}

Explanation::Rate Explanation::rate_of(std::size_t number) const {
  const Outcome& outcome = outcomes_.at(number).value();
  if (!outcome.failure.empty()) return {0, 0, 0, 0, outcome.failure};
  const NamedFigures& its = outcome.figures;
  if (!run_.camera)
    return {its.real("frames_per_second.core"), 0, 0, its.real("energy.memory_mj_per_frame"), ""};
  Rate rate = {its.real("frames_per_second.steady"), its.real("frames_per_second.steady_uncertainty"),
               its.integer("lost_pixels"), 0, ""};
  const Proven& proven = proven_[number];
  if (!rate.loses_pixels()) {
    const explore::Range range = explore::narrowed(proven.rate, rate.frames_per_second, rate.uncertainty);
    rate.frames_per_second = std::clamp(rate.frames_per_second, range.least, range.most);
    rate.uncertainty = std::max(rate.frames_per_second - range.least, range.most - rate.frames_per_second);
  }
  // The energy of a frame in the long run, too, with whole pictures: a run also counts its start.
  double pj = proven.work_pj;
  const std::vector<bool> used = platform::used_banks(board_of(number));
  for (std::size_t index = 0; index < used.size(); ++index) {
    if (!used[index]) continue;
    const platform::BankConfig& bank = board_of(number).banks[index];
    const memory::BankEnergy of_bank = platform::energy_of(bank);
    const std::string path = "banks." + bank.name + ".energy.";
    pj += of_bank.standby_mw * 1e9 / rate.frames_per_second +
          static_cast<double>(of_bank.row_pj * its.integer(path + "rows_opened") +
                              of_bank.refresh_pj * its.integer(path + "refreshes")) /
              static_cast<double>(its.integer("frames"));
  }
  rate.memory_mj = pj / 1e9;
  return rate;
}

Explanation::BusiestBank Explanation::busiest_bank_of(std::size_t number) const {
  if (run_.camera) return proven_[number].busiest;
  const NamedFigures& row = outcomes_.at(number).value().figures;
  BusiestBank busiest;
  std::int64_t most = -1;
  for (const platform::BankConfig& bank : board_of(number).banks) {
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

void Explanation::read_steps() {
  for (std::size_t i = 0; i < knobs_.possible.size(); ++i) {
    const explore::KnobStep& knob = knobs_.possible[i];
    if (!outcomes_[i + 1]) continue;
    ++evaluated_;
    Step step{&knob, rate_of(i + 1), {}};
    if (step.rate.failure.empty()) step.busiest = busiest_bank_of(i + 1);
    steps_.push_back(std::move(step));
  }
  std::stable_sort(steps_.begin(), steps_.end(), [](const Step& a, const Step& b) {
    if (a.rate.failure.empty() != b.rate.failure.empty()) return a.rate.failure.empty();
    if (a.rate.loses_pixels() != b.rate.loses_pixels()) return b.rate.loses_pixels();
    return a.rate.frames_per_second > b.rate.frames_per_second;
  });
  std::set<std::string> groups;
  std::set<std::string> whole;  // groups with an alternative that loses no pixels
  for (const Step& step : steps_) {
    if (step.rate.failure.empty() && !step.rate.loses_pixels()) whole.insert(step.step->group);
  }
  const auto is_alternative = [&](const Step& step) {
    const std::string& group = step.step->group;
    if (group.empty() || !step.rate.failure.empty()) return false;
    return (step.rate.loses_pixels() && whole.count(group) > 0) || !groups.insert(group).second;
  };
  steps_.erase(std::remove_if(steps_.begin(), steps_.end(), is_alternative), steps_.end());
}

double Explanation::busy_percent(const std::string& resource) const {
  const NamedFigures& row = figures();
  const auto number = [&row](const std::string& path) { return static_cast<double>(row.integer(path)); };
  const std::size_t space = resource.find(' ');
  const std::string name = space == std::string::npos ? "" : resource.substr(space + 1);
  if (resource == "camera")
    return 100 * number("cameras.left.captured_frames") / number("cameras.left.frames");
  if (resource == "pci") return 100 * number("pci.busy_clocks") / number("pci.clocks");
  if (resource == "bridge") return 100 * number("bridge.local_busy_clocks") / number("bridge.local_clocks");
  if (resource == "matcher") {
    const fpga::FrameGeometry geometry(platform::core_config(board_));
    const auto of_frame = static_cast<double>((geometry.consume_cycles + geometry.drain_cycles) *
                                              static_cast<unsigned>(geometry.folds));
    return 100 * number("frames") * of_frame / number("cycles");
  }
  if (const auto bank = platform::bank_of_resource(resource))
    return 100 * number("banks." + *bank + ".busy_cycles") / number("cycles");
  const std::string port = "ports." + name;
  return 100 * (number(port + ".grants") + number(port + ".passed_cycles")) / number("cycles");
}

void Explanation::add_resource(const Resource& found) {
  const auto known = std::find_if(resources_.begin(), resources_.end(),
                                  [&](const auto& other) { return other.name == found.name; });
  if (known == resources_.end()) {
    resources_.push_back(found);
  } else if (found.headroom_percent != known->headroom_percent) {
    if (found.headroom_percent < known->headroom_percent) *known = found;
    known->varies = true;
  }
}

void Explanation::compare_resources(const std::vector<double>& frame_cycles) {
  const double clock_hz = board_.fpga.clock_mhz * 1e6;
  const auto around = platform::computer_bounds(board_, accesses_, true);
  const std::string of = run_.camera ? "bound.system" : "bound.core";
  rate_bound_ = {figures_.text(of + "_limited_by"), figures_.real(of)};
  if (now_.loses_pixels()) {
    const platform::Bound core = platform::core_bound(board_, accesses_);
    rate_bound_ = {core.core_limited_by, core.core};
    if (around.front().frames_per_second < core.core) rate_bound_ = around.front();  // the cameras
  }
  const double rate = std::min(now_.frames_per_second, rate_bound_.frames_per_second);
  const double stretch = run_.camera ? std::max(1.0, clock_hz / mean_of(frame_cycles) / rate) : 1;
  for (std::size_t frame = 0; frame < std::min(bounds_.size(), frame_cycles.size()); ++frame) {
    for (const platform::ResourceBound& bound : bounds_[frame]) {
      if (run_.camera && platform::bank_of_resource(bound.resource))
        continue;  // below, with the accesses of the host
      const auto needed = static_cast<double>(bound.cycles);
      add_resource({bound.resource, clock_hz / needed, 100 * (1 - needed / (stretch * frame_cycles[frame])),
                    busy_percent(bound.resource), frame});
    }
  }
  if (run_.camera) {
    const auto without_captures = platform::computer_bounds(board_, accesses_, false);
    for (const platform::RateBound& part : around) {
      add_resource({part.resource, part.frames_per_second, 100 * (1 - rate / part.frames_per_second),
                    busy_percent(part.resource), 0});
      if (platform::bank_of_resource(part.resource)) continue;
      const auto same = std::find_if(without_captures.begin(), without_captures.end(),
                                     [&](const auto& other) { return other.resource == part.resource; });
      pair_seconds_[part.resource] = 1 / part.frames_per_second - 1 / same->frames_per_second;
    }
  }
  std::stable_sort(resources_.begin(), resources_.end(), [](const Resource& a, const Resource& b) {
    return a.headroom_percent < b.headroom_percent;
  });
}

double Explanation::picture_seconds() const {
  const platform::ImageConfig& image = board_.image;
  return 1e-12 *
         static_cast<double>(capture::CameraTiming({image.width, image.height, board_.cameras.frame_rate_hz,
                                                    board_.cameras.trigger})
                                 .last_pixel_ps());
}

void Explanation::share_time(std::vector<double> frame_cycles) {
  const std::uint64_t turn = bounds_.size();
  double frames_share = 100;
  if (run_.camera) {
    for (const Reason& reason : kReasons) {
      const double share = 100 * figures_.real(fmt::format("core_waits.{}", reason.why));
      frames_share -= share;
      if (share > 0) budget_.core_waits[reason.why] = share;
    }
    const std::uint64_t window = platform::steady_frames(run_.frames, turn);
    frame_cycles.erase(frame_cycles.begin(), frame_cycles.end() - static_cast<std::ptrdiff_t>(window));
  }
  const double mean = mean_of(frame_cycles);
  double needed = 0;  // by matcher and ports
  for (const std::vector<platform::ResourceBound>& of_frame : bounds_) {
    std::uint64_t most = 0;
    for (const platform::ResourceBound& bound : of_frame) {
      if (!platform::bank_of_resource(bound.resource)) most = std::max(most, bound.cycles);
    }
    needed += static_cast<double>(most) / static_cast<double>(turn);
  }
  const double waitless = board_.fpga.clock_mhz * 1e6 / waitless_frames_per_second(board_, tables_, turn);
  budget_.bound = frames_share * needed / mean;
  budget_.queues = frames_share * (waitless - needed) / mean;
  budget_.waits = frames_share * (mean - waitless) / mean;
}

std::optional<platform::BlameRow> longest_wait(const Explanation& explanation, const std::string& resource) {
  for (const platform::BlameRow& wait : explanation.group_blames()) {
    if (wait.port != kHost && (resource.empty() || platform::resource_of_bank(wait.bank) == resource))
      return wait;
  }
  return std::nullopt;
}

std::string limiter_text(const Explanation& explanation) {
  if (!explanation.now().loses_pixels()) return rate_limiter_text(explanation);
  return lost_pixels_text(explanation) + ". With this loss the rate is limited by " +
         rate_limiter_text(explanation);
}

std::string budget_text(const Explanation& explanation) {
  const Budget& budget = explanation.budget();
  std::string text = fmt::format("{:.2f} % the matcher and the ports", budget.bound);
  if (budget.queues >= kVisiblePercent) text += fmt::format(", {:.2f} % queues and latencies", budget.queues);
  if (budget.waits >= kVisiblePercent) text += fmt::format(", {:.2f} % waits for banks", budget.waits);
  for (const auto& [why, share] : budget.core_waits) {
    if (share >= kVisiblePercent)
      text += fmt::format(", {:.2f} % the core waits for {}", share, reason_text(explanation, why));
  }
  return text;
}

Json explanation_document(const platform::BoardConfig& board, const Explanation& explanation) {
  const Explanation::Rate& now = explanation.now();
  const NamedFigures& row = explanation.figures();
  const std::string of = explanation.camera() ? "bound.system" : "bound.core";
  Json document = {
      {"schema", 1},
      {"board", board.name},
      {"source", explanation.camera() ? "camera" : "preloaded"},
      {"frames", explanation.frames()},
      {"frames_per_second", now.frames_per_second},
      {"loses_pixels", now.loses_pixels()},
      {"lost_pixels", now.lost_pixels},
      {"bound", {{"frames_per_second", row.real(of)}, {"limited_by", row.text(of + "_limited_by")}}}};
  if (explanation.camera()) document["uncertainty_frames_per_second"] = now.uncertainty;
  document["limited_by"] = limiter_text(explanation);
  document["memory_mj_per_frame"] = now.memory_mj;
  const Budget& budget = explanation.budget();
  document["time_percent"] = {{"bound", budget.bound}, {"queues", budget.queues}, {"waits", budget.waits}};
  for (const auto& [why, share] : budget.core_waits) document["time_percent"]["core_waits"][why] = share;
  const double queue = result_queue_percent(explanation);
  if (queue > 0) document["result_queue_wait_percent"] = queue;
  document["resources"] = resources_json(explanation);
  document["blame"] = blame_json(explanation);
  document["area"] = stats::area_json(board);
  document["pins"] = platform::pins_of(board);
  if (!explanation.interruption().empty()) document["interrupted"] = explanation.interruption();
  add_changes(explanation, document);
  return document;
}

}  // namespace stereotlm::runs
