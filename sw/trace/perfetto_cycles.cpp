#include "sw/trace/perfetto_cycles.h"

#include <fmt/format.h>

#include <string>

namespace stereotlm::trace {

using fpga::CoreCycle;
using fpga::Intent;
using fpga::PortCycle;

namespace {

// Arrows of waits inside a window, and of data, have numbers of their own. Those of rows are small.
constexpr std::uint64_t kFirstWaitFlow = std::uint64_t{1} << 62U;
constexpr std::uint64_t kDataFlow = std::uint64_t{1} << 63U;

}  // namespace

PerfettoCycles::PerfettoCycles(const TraceBoard& board, PerfettoTree& tree)
    : board_(board),
      slots_(board.geometry),
      matcher_(tree, TrackGroup::kCore, 2, "matcher"),
      lanes_{LazyTrack(tree, TrackGroup::kQueues, 0, "left lane", "slots"),
             LazyTrack(tree, TrackGroup::kQueues, 1, "right lane", "slots")},
      results_(tree, TrackGroup::kQueues, 2, "results", "words") {
  for (std::size_t requester = 0; requester < fpga::kRequesters; ++requester)
    ports_.emplace_back(tree, TrackGroup::kPorts, 3 * requester + 1,
                        std::string(fpga::requester_name(requester)) + " cycles");
  for (std::size_t bank = 0; bank < board.banks.size(); ++bank) {
    const std::string& name = board.bank_name(bank);
    const std::string first = board.has_separate_ports(bank) ? " read cycles" : " cycles";
    banks_.push_back(
        {BankRun::kNobody, BankRun::kNobody, 0, {tree, TrackGroup::kBanks, 5 * bank + 2, name + first}});
    banks_.push_back({BankRun::kNobody,
                      BankRun::kNobody,
                      0,
                      {tree, TrackGroup::kBanks, 5 * bank + 3, name + " write cycles"}});
    access_.push_back({"reads " + name, "writes " + name});
  }
}

void PerfettoCycles::cycle(const CoreCycle& cycle) {
  if (next_cycle_ && *next_cycle_ != cycle.cycle) end();
  next_cycle_ = cycle.cycle + 1;
  for (std::size_t port = 0; port < fpga::kPortCount; ++port) {
    continue_or_begin(runs_[port], run_of(cycle, port), cycle);
    set_owner(cycle, port);
  }
  for (std::size_t port = 0; port < fpga::kPortCount; ++port) {
    if (cycle.ports[port].granted) write_access(cycle, port);
  }
  for (BankRun& run : banks_) change_owner(run, cycle.cycle);
  set_working(cycle.works, cycle.cycle);
  count_queues(cycle);
}

void PerfettoCycles::end() {
  if (!next_cycle_) return;
  CoreCycle idle;
  idle.cycle = *next_cycle_;
  for (PortRun& run : runs_) continue_or_begin(run, {}, idle);
  for (BankRun& run : banks_) change_owner(run, idle.cycle);
  set_working(false, idle.cycle);
  count_queues(idle);
  next_cycle_.reset();
}

PerfettoCycles::PortRun PerfettoCycles::run_of(const CoreCycle& cycle, std::size_t port) {
  const PortCycle& now = cycle.ports[port];
  PortRun run;
  run.requester = requester_of_port(port, cycle.host_traffic);
  run.first_cycle = cycle.cycle;
  switch (now.intent) {
    case Intent::kRequest:
      if (now.granted) break;
      run.state = State::kWaits;
      run.bank = now.bank;
      run.by = now.by;
      break;
    case Intent::kPass:
      run.state = State::kPasses;
      break;
    case Intent::kBlocked:
      run.state = State::kBlocked;
      break;
    case Intent::kStarved:
      run.state = State::kStarved;
      break;
    case Intent::kIdle:
      break;
  }
  return run;
}

void PerfettoCycles::continue_or_begin(PortRun& run, PortRun wanted, const CoreCycle& cycle) {
  const bool is_same = run.state == wanted.state && run.requester == wanted.requester &&
                       run.bank == wanted.bank && run.by == wanted.by;
  if (is_same) return;
  if (run.state != State::kNone) write_run(run, cycle.cycle);
  run = wanted;
  if (run.state != State::kWaits || run.by == fpga::kTurnaroundToBlame) return;
  run.flow = kFirstWaitFlow + waits_++;
  flows_[run.by].push_back(run.flow);
}

void PerfettoCycles::write_run(const PortRun& run, std::uint64_t end_cycle) {
  const std::uint64_t cycles = end_cycle - run.first_cycle;
  std::string name;
  std::vector<std::uint64_t> flows;
  switch (run.state) {
    case State::kNone:
      return;
    case State::kWaits:
      name = board_.wait_text(run.requester, cycles, run.by, run.bank);
      if (run.flow != 0) flows.push_back(run.flow);
      break;
    case State::kPasses:
      name = "passes";
      break;
    case State::kBlocked:
      name = "blocked";
      break;
    case State::kStarved:
      name = "starved";
      break;
  }
  ports_[run.requester]->slice(ns(run.first_cycle), ns(end_cycle), name, {{"cycles", cycles}}, flows);
}

void PerfettoCycles::write_access(const CoreCycle& cycle, std::size_t port) {
  const PortCycle& now = cycle.ports[port];
  const std::size_t requester = requester_of_port(port, cycle.host_traffic);
  add_data_flows(cycle, port);
  const std::string& name = access_[now.bank][writes(requester) ? 1 : 0];
  const std::uint64_t begin = ns(cycle.cycle);
  const std::uint64_t end = ns(cycle.cycle + 1);
  PerfettoTrack& track = ports_[requester].get();
  std::vector<std::uint64_t>& flows = flows_[requester];
  if (port == fpga::kHostPort) {
    track.slice(begin, end, name, {{"address", now.address}}, flows);
  } else {
    const bool is_result = port == fpga::kResultPort;
    const SlotPlace place = is_result ? slots_.place_of_word(now.item) : slots_.place(now.item);
    track.slice(begin, end, name,
                {{"address", now.address},
                 {is_result ? "word" : "slot", now.item},
                 {"row", static_cast<std::uint64_t>(place.row)},
                 {"column", static_cast<std::uint64_t>(place.column)}},
                flows);
  }
  flows.clear();
}

// The arrows of a pixel: from its table entry to itself, and from the left pixel to the word that holds its
// disparity. Each has a number of its own, because a pixel that is passed ends the first and begins none.
void PerfettoCycles::add_data_flows(const CoreCycle& cycle, std::size_t port) {
  if (port == fpga::kHostPort || !cycle.frame) return;
  std::vector<std::uint64_t>& flows = flows_[port];
  const auto add = [&](Arrow arrow, fpga::Side side, std::uint64_t slot) {
    const std::uint64_t pixel = (*cycle.frame * board_.geometry.slots + slot) * 2 + fpga::index_of(side);
    flows.push_back(kDataFlow | (pixel * 2 + static_cast<std::uint64_t>(arrow)));
  };
  const std::uint64_t item = cycle.ports[port].item;
  if (port == fpga::kResultPort) {
    const auto slots = slots_.slots_of_word(item);
    if (!slots) return;
    for (const std::uint64_t slot : *slots) add(Arrow::kToResult, fpga::Side::kLeft, slot);
    return;
  }
  const fpga::Side side = fpga::kPorts[port].side;
  add(Arrow::kToPixel, side, item);
  if (port == fpga::pixel_port(fpga::Side::kLeft)) add(Arrow::kToResult, side, item);
  if (board_.core.joint_tables && port == fpga::lut_port(fpga::Side::kLeft))
    add(Arrow::kToPixel, fpga::Side::kRight, item);
}

void PerfettoCycles::set_owner(const CoreCycle& cycle, std::size_t port) {
  const PortCycle& now = cycle.ports[port];
  if (now.intent != Intent::kRequest) return;
  const std::size_t requester = requester_of_port(port, cycle.host_traffic);
  const bool is_second = writes(requester) && board_.has_separate_ports(now.bank);
  std::size_t& next = banks_[2 * now.bank + (is_second ? 1 : 0)].next;
  if (now.granted)
    next = requester;
  else if (now.by == fpga::kTurnaroundToBlame)
    next = now.by;
}

void PerfettoCycles::change_owner(BankRun& run, std::uint64_t cycle) {
  if (run.next != run.owner) {
    if (run.owner != BankRun::kNobody)
      run.track->slice(ns(run.first_cycle), ns(cycle), fpga::requester_name(run.owner),
                       {{"cycles", cycle - run.first_cycle}});
    run.owner = run.next;
    run.first_cycle = cycle;
  }
  run.next = BankRun::kNobody;
}

void PerfettoCycles::set_working(bool works, std::uint64_t cycle) {
  if (works == works_since_.has_value()) return;
  if (!works) {
    matcher_->slice(ns(*works_since_), ns(cycle), "works", {{"cycles", cycle - *works_since_}});
    works_since_.reset();
  } else {
    works_since_ = cycle;
  }
}

void PerfettoCycles::count_queues(const CoreCycle& cycle) {
  const std::uint64_t time = ns(cycle.cycle);
  for (std::size_t side = 0; side < lanes_.size(); ++side) lanes_[side]->count(time, cycle.lane_slots[side]);
  results_->count(time, cycle.result_words);
}

}  // namespace stereotlm::trace
