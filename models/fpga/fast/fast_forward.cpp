#include "models/fpga/fast/fast_forward.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace stereotlm::fpga {
namespace {

// After this number of groups with the same accesses, the walk expects more groups with these accesses.
constexpr int kManyAlike = 8;

// See FastForward::slots_ahead_.
std::uint64_t slots_ahead(const FrameGeometry& geometry, int lane_fifo_slots) {
  if (geometry.lanes == 1) return static_cast<std::uint64_t>(lane_fifo_slots);
  const int fewest = geometry.slots_of_lane(geometry.lanes - 1);  // of a column in a lane
  return static_cast<std::uint64_t>((lane_fifo_slots / fewest + 1) * geometry.slots_per_column);
}

// The number of columns whose slots can have an effect before a group ends, and the one behind.
std::uint64_t columns_of_window(const FrameGeometry& geometry, std::uint64_t slots_ahead) {
  return 4 + slots_ahead / static_cast<std::uint64_t>(geometry.slots_per_column) + 3;
}

// After these groups of four columns, all words that were in the queue before them have been written.
std::uint64_t result_groups(const CoreConfig& config, const FrameGeometry& geometry) {
  return static_cast<std::uint64_t>((config.result_fifo_words + geometry.rows) / geometry.last_rows + 1);
}

// The words of TransitionCache::Accesses for both sides.
std::size_t words_of_accesses(const FrameGeometry& geometry, std::uint64_t slots_ahead) {
  return 2 * ((4 * static_cast<std::uint64_t>(geometry.slots_per_column) + slots_ahead + 63) / 64);
}

static_assert(memory::kBankCountRule.max <= 1 << 6U &&
              2 * memory::kBankCountRule.max - 1 <= HostRequests::kMostRoute);

}  // namespace

FastForward::FastForward(const CoreConfig& config, memory::Arbitration& arbitration)
    : CoreStepper(config, arbitration),
      config_(config),
      slots_ahead_(slots_ahead(control().geometry(), config.lane_fifo_slots)),
      known_(words_of_accesses(control().geometry(), slots_ahead_)),
      no_accesses_(words_of_accesses(control().geometry(), slots_ahead_)),
      accesses_(no_accesses_),
      accesses_before_(no_accesses_),
      open_rows_(control().geometry()),
      handled_(control().lanes().size()) {
  for (std::size_t lane = 0; lane < handled_.size(); ++lane)
    handled_[lane].slot = control().lane(lane).first_slot();
}

void FastForward::start_direct_frame(const AccessPatterns& patterns) {
  start_stepped_frame();
  patterns_ = &patterns;
  find_layout();
  for (const Side side : kSides) {
    const AccessPattern* const pattern = &patterns[index_of(side)];
    const bool has_table = control().lane(control().lane_index(side, 0)).has_table();
    if (has_table && !pattern->needs_all_pixels()) varying_[index_of(side)] = pattern;
  }
  is_regular_ = std::all_of(varying_.begin(), varying_.end(), [](const AccessPattern* pattern) {
    return pattern == nullptr || pattern->is_identity();
  });
}

void FastForward::start_stepped_frame() {
  if (ahead_.cycles != 0) throw std::logic_error("a frame starts before the last one was settled");
  stepped_.reset();
  is_walking_ = false;
  varying_ = {};
}

// Sets can_walk_, layout_ and open_rows_. Buffers lie alike in frames if their parts lie in the same banks,
// and in sdram at the same places among the internal banks.
void FastForward::find_layout() {
  SdramTimings timings(arbitration().banks());
  for (std::size_t bank = 0; arbitration().has_rows() && bank < timings.size(); ++bank) {
    const memory::SdramRows* const rows = arbitration().arbiter(bank).rows();
    timings[bank] = rows != nullptr ? &rows->timing() : nullptr;
  }
  std::vector<SdramPart> sdram = sdram_parts(config_, placements(), timings);
  can_walk_ = are_apart(sdram) && follows_from_places();
  if (!can_walk_) return;
  std::vector<std::uint64_t> places;
  for (std::size_t group = 0; group < kCoreGroupCount; ++group) {
    if (!has_group(config_, group)) continue;
    const std::vector<std::uint32_t>& parts = placements()[group].parts();
    places.push_back(parts.size());
    for (const std::uint32_t base : parts) places.push_back(registers::bank_of(base));
  }
  for (const SdramPart& part : sdram) places.push_back(floor_remainder(part.base, part.turn()));
  auto layout = layouts_.find(places);
  if (layout == layouts_.end()) {
    const FrameGeometry& geometry = control().geometry();
    const std::uint64_t groups = result_groups(config_, geometry);
    FrameAreas areas(config_, columns_of_window(geometry, slots_ahead_), 4 * groups, placements(), sdram);
    layout = layouts_.emplace(places, Layout{layouts_.size(), std::move(areas)}).first;
  }
  layout_ = &layout->second;
  open_rows_.start_frame(std::move(sdram), arbitration());
}

// Whether the places in the frame determine the banks and the rows of sdram that the ports request. They do
// not where a striped picture, or one in sdram, is read through a table that points to other pixels.
bool FastForward::follows_from_places() const {
  for (const Side side : kSides) {
    const memory::Port pixel = control().pixel_port(control().lane_index(side, 0));
    if (memory::has(arbitration().placed(), pixel) && !(*patterns_)[index_of(side)].is_identity())
      return false;
  }
  return true;
}

void FastForward::settle(std::uint64_t cycle) {
  stepped_.reset();
  leave_walk(cycle);
  if (is_host_routed_) arbitration().unroute(control().ports().host());
  is_host_routed_ = false;
}

// LaneControl::correct_marks() of a lane.
std::uint64_t FastForward::marks(std::size_t number) const {
  const LaneControl& lane = control().lane(number);
  if (!lane.has_table() || lane.handled() == lane.taken()) return 0;
  const Side side = control().side_of(number);
  std::uint64_t marks = 0;
  SlotCursor slot = lane.first_slot();
  slot.advance(lane.handled());
  for (std::uint64_t mark = 1, left = lane.taken() - lane.handled(); left > 0; --left, mark <<= 1U) {
    if (!slot.empty() && accesses_pixel(side, slot)) marks |= mark;
    slot.advance();
  }
  return marks;
}

void FastForward::correct_marks() {
  for (std::size_t lane = 0; lane < control().lanes().size(); ++lane)
    control().correct_marks(lane, marks(lane));
}

// `kMayRequest`: false if the host does not request, as in most cycles. That costs less.
template <bool kMayRequest>
memory::PortMask FastForward::step_core(std::uint64_t cycle, bool host_requests) {
  return step(
      cycle, kMayRequest && host_requests,
      [this](const CoreControl::Decision& /*decision*/, memory::PortMask granted) {
        return needs_pixel(granted);
      },
      [this](std::size_t lane) { return next_entry(lane); });
}

// The entry of the slot that the pixel port of a lane handles next.
std::uint32_t FastForward::next_entry(std::size_t number) {
  const LaneControl& lane = control().lane(number);
  Handled& handled = handled_[number];
  if (lane.handled() < handled.slots) handled = {0, lane.first_slot()};
  if (lane.handled() == handled.slots + 1) {
    handled.slot.advance();
  } else if (lane.handled() != handled.slots) {
    handled.slot.advance(lane.handled() - handled.slots);
  }
  handled.slots = lane.handled();
  return (*patterns_)[index_of(control().side_of(number))].entry(handled.slot.column(), handled.slot.row());
}

memory::PortMask FastForward::step(std::uint64_t cycle, bool host_requests) {
  leave_walk(cycle);
  stepped_.reset();
  return step_core<true>(cycle, host_requests);
}

std::uint64_t FastForward::run_ahead(std::uint64_t cycle, std::uint64_t end) {
  while (cycle < end && !control().frame_done()) {
    if (is_walking_) cycle = walk(cycle, end);
    if (cycle < end) cycle = step_group(cycle, end);
  }
  catch_up(cycle);
  return cycle;
}

FastForward::Served FastForward::serve_host(std::uint64_t& cycle, const Route& route, std::uint64_t first,
                                            std::size_t words) {
  if (!is_walking_) stepped_.reset();  // a group that is begun without the burst is not recorded
  route_host(cycle, route, first);
  if (ConflictRecorder* const conflicts = this->conflicts()) conflicts->set_host_traffic(route.traffic);
  host_ = {first, words, static_cast<std::uint8_t>(route.bank << 1U | std::size_t{route.write}), route.word};
  Served served;
  const std::uint64_t end = std::max(cycle, first) + kMostHostCycles;
  while (host_.words != 0 && cycle < end && !control().frame_done()) {
    if (is_walking_ && cycle < first) cycle = walk(cycle, first);
    if (const auto found = find_host(cycle)) {
      const HostGrants& grants = known_.host(*found);
      if (grants.words != 0) served.last_cycle = cycle + grants.cycles - 1;
      cycle += known_.progress(*found).cycles;
      host_.words -= grants.words;
      host_.first = cycle;
      follow(*found, cycle);
    } else {
      const std::size_t words_before = host_.words;
      cycle = step_group(cycle, end);
      if (host_.words != words_before) served.last_cycle = host_.first - 1;
    }
  }
  served.words = words - host_.words;
  if (host_.words != 0) {
    host_.words = 0;
    stepped_.reset();
  }
  return served;
}

// Routes the host to the bank. If a port was alone there until now, first runs the core up to `first`.
void FastForward::route_host(std::uint64_t& cycle, const Route& route, std::uint64_t first) {
  memory::Arbitration& arbitration = this->arbitration();
  const bool is_new = !arbitration.is_shared(route.bank);
  if (is_new) {
    cycle = run_ahead(cycle, std::max(cycle, first));
    stepped_.reset();
    leave_walk(cycle);
  }
  arbitration.visit(control().ports().host(), route.bank, route.write);
  is_host_routed_ = true;
  if (is_new) begin_walk(cycle);
}

// Steps to the end of the group or of the host's burst, but not beyond `end` or the end of the frame.
std::uint64_t FastForward::step_group(std::uint64_t cycle, std::uint64_t end) {
  if (is_walking_) end_walk(cycle);
  const auto is_over = [&] { return cycle >= end || completed_group() || control().frame_done(); };
  bool burst_ends = false;
  if (host_.words == 0) {
    do {
      step_core<false>(cycle++, false);
      cycle = skip_waiting(cycle, end);
    } while (!is_over());
  } else {
    do {
      const bool requests = cycle >= host_.first;
      const memory::Port port = control().ports().host();
      if (memory::has(arbitration().placed(), port))
        arbitration().place(port, arbitration().bank_of(port), host_.word);
      const memory::PortMask granted = step_core<true>(cycle++, requests);
      if (memory::has(granted, port)) {
        host_.first = cycle;
        ++host_.word;
        burst_ends = --host_.words == 0;
      }
      cycle = skip_waiting(cycle, std::min(end, host_.first));
    } while (!burst_ends && !is_over());
  }
  if (burst_ends || completed_group()) begin_walk(cycle);
  return cycle;
}

// Skips the cycles before `end` in which everything waits for the matcher. Returns the next cycle.
std::uint64_t FastForward::skip_waiting(std::uint64_t cycle, std::uint64_t end) {
  if (end <= cycle) return cycle;
  const std::uint64_t cycles = std::min(end - cycle, control().waiting_cycles());
  if (cycles != 0) control().skip_waiting(cycles);
  skipped_cycles_ += cycles;
  return cycle + cycles;
}

// Begins to follow transitions, if possible.
void FastForward::begin_walk(std::uint64_t cycle) {
  if (stepped_) end_stepped(cycle);
  if (!can_walk_) return;
  room_ = room();
  if (!holds_group(room_)) return;
  if (known_.is_full()) known_.clear();
  state_ = state(cycle);
  consumed_ = control().match().consumed();
  left_of_group_ = control().match().cycles_of_group_left();
  set_area();
  set_refresh(cycle);
  is_walking_ = true;
  if (ConflictRecorder* const conflicts = this->conflicts()) conflicts->skip_from(cycle);
}

// Takes the core to the end of the walk.
void FastForward::leave_walk(std::uint64_t cycle) {
  if (!is_walking_) return;
  catch_up(cycle);
  is_walking_ = false;
}

// Leaves the walk, and records the transition that is stepped next if it is not known.
void FastForward::end_walk(std::uint64_t cycle) {
  leave_walk(cycle);
  if (!holds_group(room_)) return;
  if (host_.words == 0 && find_next(cycle)) return;
  stepped_ = {state_,       accesses(), host_, progress(cycle), control().counts(), control().match().part(),
              refresh_left_};
  arbitration().begin_recording();
}

// Follows the transitions to the ends of groups that are over before `end`.
std::uint64_t FastForward::walk(std::uint64_t cycle, std::uint64_t end) {
  // A group has at least as many cycles as slots.
  if (left_of_group_ != cycles_of_group() && end - cycle >= left_of_group_) {
    const auto found = find_next(cycle);
    if (found && known_.progress(*found).fits(room_of_area(end - cycle))) {
      cycle += known_.progress(*found).cycles;
      follow(*found, cycle);
    }
  }
  if (left_of_group_ != cycles_of_group() || end - cycle < cycles_of_group()) return cycle;
  AreaMark mark;
  for (bool is_over = false; !is_over;) {
    Progress room = room_of_area(std::min(end - cycle, refresh_left_));
    if (const ConflictRecorder* const conflicts = this->conflicts())
      room.consumed = std::min(room.consumed, cycles_to(conflicts->strip_end_column()));
    Progress skipped = room;
    state_ = varies() ? walk_varying(state_, room) : known_.walk(state_, no_accesses_, room, log());
    skipped.subtract(room);
    skip(skipped);
    cycle += skipped.cycles;
    const bool is_strip_recorded = record_skipped(cycle, cycles_of_group());
    const bool is_in_next = change_area();
    is_over = !is_in_next && !is_strip_recorded;
    if (refresh_left_ == UINT64_MAX) {
      if (is_in_next && is_regular_ && conflicts() == nullptr) cycle = repeat_areas(mark, cycle, end);
      continue;
    }
    if (!is_over) continue;
    const auto found = find_next(cycle);
    is_over = !found || !known_.progress(*found).fits(room_of_area(end - cycle));
    if (is_over) continue;
    cycle += known_.progress(*found).cycles;
    follow(*found, cycle);
  }
  return cycle;
}

// The transition from `cycle` on to the end of the group, without requests of the host.
std::optional<TransitionCache::Transition> FastForward::find_next(std::uint64_t cycle) {
  const TransitionCache::Accesses& accesses = this->accesses();
  const auto found = known_.find(state_, accesses);
  if (refresh_left_ == UINT64_MAX || (found && known_.progress(*found).cycles <= refresh_left_)) return found;
  const auto before_refresh = known_.find_with_last_words(state_, last_words(state_, cycle));
  return before_refresh ? known_.find(*before_refresh, accesses) : std::nullopt;
}

// The last words of a state from which a transition with a refresh begins in `cycle`. None of them is 0 but
// the last.
const memory::StateWords& FastForward::last_words(StateNumber number, std::uint64_t cycle) {
  find_refreshes(number, cycle);
  last_words_.clear();
  for (const std::int64_t left : refreshes_) last_words_.push_back(static_cast<std::uint64_t>(2 * left + 1));
  last_words_.push_back(known_.state(number).back());
  return last_words_;
}

// Sets refreshes_ for a state in `cycle`.
void FastForward::find_refreshes(StateNumber number, std::uint64_t cycle) {
  refreshes_.clear();
  const auto rows = known_.state(number).begin() + static_cast<std::ptrdiff_t>(rows_place_);
  open_rows_.append_refreshes(cycle, rows, refreshes_);
}

// Sets refresh_left_ for the state of the walk in `cycle`.
void FastForward::set_refresh(std::uint64_t cycle) {
  refresh_left_ = UINT64_MAX;
  if (open_rows_.refreshes() == 0) return;
  find_refreshes(state_, cycle);
  for (const std::int64_t left : refreshes_)
    refresh_left_ = std::min(refresh_left_, static_cast<std::uint64_t>(std::max(left, std::int64_t{0})));
}

// If the walk has come into the state of the mark, follows again what it has followed since then, as often as
// the areas repeat: a frame of striped buffers then takes a few strips. Returns the next cycle.
std::uint64_t FastForward::repeat_areas(AreaMark& mark, std::uint64_t cycle, std::uint64_t end) {
  const std::size_t area = layout_->areas.index_of(consumed_ / cycles_per_column());
  const Progress progress{cycle, consumed_, ahead_.words};
  ++mark.areas;
  if (mark.is_set && state_ == mark.state) {
    Progress since = progress;
    since.subtract(mark.progress);
    Progress room = room_;
    room.cycles = end - cycle;
    const std::uint64_t times = std::min(layout_->areas.repeats(mark.area, area), since.times_in(room));
    if (times == 0) return cycle;
    known_.repeat_loop(times);
    Progress repeated;
    repeated.add(since, times);
    skip(repeated);
    enter_area();
    mark = {};
    return cycle + repeated.cycles;
  }
  if (mark.areas < mark.next) return cycle;
  known_.begin_loop();
  mark = {true, state_, area, progress, 0, 2 * mark.next};
  return cycle;
}

// The transition from `cycle` on, in which the host requests its words.
std::optional<TransitionCache::Transition> FastForward::find_host(std::uint64_t cycle) {
  std::optional<HostRequests> requests = is_walking_ ? requests_of(host_, cycle) : std::nullopt;
  if (!requests || host_opens_rows()) return std::nullopt;
  const TransitionCache::Accesses& accesses = this->accesses();
  auto found = known_.find(state_, accesses, *requests);
  if (!found) {
    requests->words = HostRequests::kEndless;
    found = known_.find(state_, accesses, *requests);
    if (found && known_.host(*found).words >= host_.words) return std::nullopt;
  }
  return found && fits_host(*found) ? found : std::nullopt;
}

// Whether a transition with requests of the host can be followed. It may run on after its last slot. But
// after the last uniform slot the state in the cache differs from that of the core. So it must leave one.
bool FastForward::fits_host(const TransitionCache::Transition& transition) const {
  const Progress& progress = known_.progress(transition);
  return progress.fits(room_of_area(refresh_left_)) && progress.consumed < room_.consumed;
}

// The requests of these words from `cycle` on. Nothing if the cache cannot hold them.
std::optional<HostRequests> FastForward::requests_of(const HostWords& host, std::uint64_t cycle) {
  const std::uint64_t first = host.first > cycle ? host.first - cycle : 0;
  if (first > HostRequests::kMostCycles) return std::nullopt;
  return HostRequests{static_cast<std::uint16_t>(first),
                      static_cast<std::uint16_t>(std::min<std::size_t>(host.words, HostRequests::kEndless)),
                      host.route};
}

// Follows one transition, which ends before `cycle`.
void FastForward::follow(const TransitionCache::Transition& transition, std::uint64_t cycle) {
  known_.follow(transition, 1, log());
  const HostGrants& host = known_.host(transition);
  host_ahead_.words += host.words;
  host_ahead_.requests += host.requests;
  state_ = transition.next;
  const std::uint64_t left_of_group = left_of_group_;
  const Progress& progress = known_.progress(transition);
  const bool is_refreshed = progress.cycles > refresh_left_;
  skip(progress);
  if (is_refreshed) set_refresh(cycle);
  record_skipped(cycle, left_of_group);
  change_area();
}

void FastForward::skip(const Progress& progress) {
  room_.subtract(progress);
  if (refresh_left_ != UINT64_MAX) refresh_left_ -= progress.cycles;
  ahead_.add(progress);
  consumed_ += progress.consumed;
  if (progress.consumed < left_of_group_) {
    left_of_group_ -= progress.consumed;
  } else {
    left_of_group_ = cycles_of_group() - (progress.consumed - left_of_group_) % cycles_of_group();
  }
  skipped_cycles_ += progress.cycles;
}

// See record_skipped().
bool FastForward::hand_over(ConflictRecorder& conflicts, std::uint64_t cycle, std::uint64_t left_of_group) {
  if (in_order_.empty()) return false;
  for (auto next = in_order_.begin(); next != in_order_.end(); next += next->length) {
    const std::uint64_t consumed = known_.progress(next->effect).consumed;
    if (next->length == 1 && consumed < left_of_group) {
      conflicts.add_part(known_.conflicts(next->effect));
      left_of_group -= consumed;
      continue;
    }
    repeated_.clear();
    for (std::uint32_t step = 0; step < next->length; ++step)
      repeated_.push_back(&known_.conflicts((next + step)->effect));
    conflicts.repeat(repeated_.data(), repeated_.size(), next->times);
    left_of_group = cycles_of_group();
  }
  in_order_.clear();
  if (!conflicts.is_at_strip_end()) return false;
  catch_up(cycle);
  conflicts.end_strip();
  return true;
}

// Takes the core and the arbiters to the state that the walk has reached.
void FastForward::catch_up(std::uint64_t cycle) {
  if (ahead_.cycles == 0) return;
  CoreControl& control = this->control();
  memory::Arbitration& arbitration = this->arbitration();
  known_.count_followed(control, arbitration);
  control.count_host(false, false, ahead_.cycles - host_ahead_.requests);
  control.count_host(true, false, host_ahead_.requests - host_ahead_.words);
  control.count_host(true, true, host_ahead_.words);
  memory::StateReader state = known_.state(state_).begin();
  control.skip_to(state, ahead_.consumed, ahead_.words);
  correct_marks();
  arbitration.set_state(cycle, state);
  open_rows_.set_state(cycle, control.match().columns(), state);
  ahead_ = {};
  host_ahead_ = {};
}

// Follows recorded transitions as far as `room` allows, and reduces `room`. Returns the next state.
FastForward::StateNumber FastForward::walk_varying(StateNumber state, Progress& room) {
  const std::uint64_t cycles = cycles_of_group();
  int alike = 0;  // groups with the accesses of the group before
  for (std::uint64_t consumed = consumed_;;) {
    accesses_before_.swap(accesses_);
    set_accesses(consumed, cycles);
    alike = consumed != consumed_ && accesses_ == accesses_before_ ? alike + 1 : 0;
    if (alike == kManyAlike) {
      alike = 0;
      const std::uint64_t left = room.consumed;
      state = walk_uniform(state, consumed, room);
      consumed += left - room.consumed;
      if (left != room.consumed) continue;
    }
    const auto found = known_.find(state, accesses_);
    if (!found) return state;
    const Progress& progress = known_.progress(*found);
    if (!progress.fits(room)) return state;
    known_.follow_group(*found, log());
    room.subtract(progress);
    state = found->next;
    consumed += cycles;
  }
}

// Follows groups with the accesses of accesses_. `consumed`: consume-cycles of the frame before them.
FastForward::StateNumber FastForward::walk_uniform(StateNumber state, std::uint64_t consumed,
                                                   Progress& room) {
  Progress uniform = room;
  uniform.consumed = std::min(uniform.consumed, uniform_cycles(consumed));
  Progress left = uniform;
  const StateNumber last = known_.walk(state, accesses_, left, log());
  uniform.subtract(left);
  room.subtract(uniform);
  return last;
}

// Returns how far the core can run before MatchControl::part() changes, or a row of results is complete.
Progress FastForward::room() const {
  return {UINT64_MAX, control().match().uniform_cycles(),
          rows().next_words() - control().result().words_written() - 1};
}

// How far transitions can be followed within `cycles` cycles and the area.
Progress FastForward::room_of_area(std::uint64_t cycles) const {
  Progress room = room_;
  room.cycles = cycles;
  room.consumed = std::min(room.consumed, area_end_ - consumed_);
  return room;
}

// Sets area_end_ for the state of the walk.
void FastForward::set_area() {
  area_end_ = layout_->areas.end_of_area(consumed_ / cycles_per_column()) * cycles_per_column();
}

// Goes on to the next area if no group fits into this one any more. Returns whether it does.
bool FastForward::change_area() {
  if (area_end_ - consumed_ >= left_of_group_ || !holds_group(room_)) return false;
  enter_area();
  return true;
}

void FastForward::enter_area() {
  state_ = known_.with_last_word(state_, layout_->areas.number_of(consumed_ / cycles_per_column()));
  set_area();
}

// The number of slots of a side that are consumed with these consume-cycles of the frame.
std::uint64_t FastForward::slots_before(std::uint64_t consumed) const {
  const FrameGeometry& geometry = control().geometry();
  const std::uint64_t cycles = cycles_per_column();
  const auto slots = static_cast<std::uint64_t>(geometry.slots_per_column);
  return consumed / cycles * slots +
         std::min(consumed % cycles * static_cast<std::uint64_t>(geometry.lanes), slots);
}

// Sets accesses_: of all slots that can be in the lanes during `cycles` consume-cycles. `consumed`:
// consume-cycles of the frame before them.
void FastForward::set_accesses(std::uint64_t consumed, std::uint64_t cycles) {
  const std::uint64_t first = slots_before(consumed);
  const std::uint64_t in_use = slots_before(consumed + cycles) - first + slots_ahead_;  // bits of a side
  const std::size_t words = accesses_.size() / 2;
  std::fill(accesses_.begin(), accesses_.end(), 0);
  for (std::size_t side = 0; side < varying_.size(); ++side) {
    if (varying_[side] == nullptr) continue;
    std::uint64_t* const of_side = accesses_.data() + side * words;
    for (std::size_t word = 0; 64 * word < in_use; ++word)
      of_side[word] = varying_[side]->pixels_of_slots(first + 64 * word);
    if (in_use % 64 != 0) of_side[in_use / 64] &= (std::uint64_t{1} << in_use % 64) - 1;
  }
}

// The number of consume-cycles, a multiple of a group's, over which set_accesses() gives the same for each
// group.
std::uint64_t FastForward::uniform_cycles(std::uint64_t consumed) const {
  const std::uint64_t first = slots_before(consumed);
  std::uint64_t groups = UINT64_MAX / cycles_of_group();
  for (const AccessPattern* pattern : varying_) {
    if (pattern == nullptr) continue;
    const std::uint64_t end = pattern->uniform_until(first);
    const std::uint64_t last = first + slots_ahead_;
    groups = std::min(groups, end < last ? 0 : (end - last) / pattern->slots_of_group());
  }
  return groups * cycles_of_group();
}

// The accesses of the slots that can be in the lanes up to the end of the group, from the state of the walk
// on.
const TransitionCache::Accesses& FastForward::accesses() {
  if (!varies()) return no_accesses_;
  set_accesses(consumed_, left_of_group_);
  return accesses_;
}

// See TransitionCache::number_of().
TransitionCache::Accesses FastForward::unhandled() const {
  TransitionCache::Accesses unhandled(accesses_.size(), ~std::uint64_t{0});
  const FrameGeometry& geometry = control().geometry();
  const std::uint64_t first = slots_before(control().match().consumed());
  for (std::size_t lane = 0; lane < control().lanes().size(); ++lane) {
    const LaneControl& of_lane = control().lane(lane);
    const std::size_t number = lane % control().ports().lanes();
    const auto slots = static_cast<std::uint64_t>(geometry.slots_of_lane(static_cast<int>(number)));
    for (std::uint64_t slot = of_lane.handled() - of_lane.handled_slots(); slot < of_lane.handled(); ++slot) {
      const std::uint64_t of_side = slot / slots * static_cast<std::uint64_t>(geometry.slots_per_column) +
                                    slot % slots * control().ports().lanes() + number;
      const std::size_t bit = index_of(control().side_of(lane)) * 32 * unhandled.size() + of_side - first;
      unhandled[bit / 64] &= ~(std::uint64_t{1} << bit % 64);
    }
  }
  return unhandled;
}

// Records the transition that has just been stepped. Does not if MatchControl::part() has changed: the next
// state then depends on the position in the frame too.
void FastForward::end_stepped(std::uint64_t cycle) {
  const Stepped stepped = *stepped_;
  stepped_.reset();
  if (stepped.part != control().match().part()) return;
  open_rows_.count(cycle);
  TransitionCache::Effect effect{progress(cycle),
                                 CoreControl::difference(control().counts(), stepped.counts),
                                 arbitration().take_recorded(),
                                 {}};
  effect.progress.subtract(stepped.begin);
  const bool is_refreshed = effect.progress.cycles > stepped.refresh_left;
  HostRequests requests;
  if (stepped.host.words != 0 && stepped.host.first < cycle) {  // the host has requested
    const std::optional<HostRequests> host = requests_of(stepped.host, stepped.begin.cycles);
    if (!host || effect.progress.cycles > HostRequests::kMostCycles) return;
    if (is_refreshed || host_opens_rows()) return;
    requests = *host;
    const std::uint64_t end = host_.words != 0 ? cycle : host_.first;  // of the requests
    effect.host.words = stepped.host.words - host_.words;
    effect.host.requests = end - stepped.begin.cycles - requests.first;
    if (effect.host.words != 0) effect.host.cycles = host_.first - stepped.begin.cycles;
    if (host_.words != 0) requests.words = HostRequests::kEndless;
  }
  StateNumber next = state(cycle);
  // A transition of a uniform area is also followed where the area goes on.
  if (const std::uint64_t area = known_.state(stepped.state).back(); FrameAreas::is_uniform_number(area))
    next = known_.with_last_word(next, area);
  const StateNumber from =
      is_refreshed ? known_.with_last_words(stepped.state, last_words(stepped.state, stepped.begin.cycles))
                   : stepped.state;
  known_.record(from, stepped.accesses, requests, next, effect, arbitration());
}

// The progress up to `cycle`. Its beginning is arbitrary: only differences have a meaning.
Progress FastForward::progress(std::uint64_t cycle) const {
  return {cycle, control().match().consumed(), control().result().words_written()};
}

FastForward::StateNumber FastForward::state(std::uint64_t cycle) {
  const std::uint64_t varies = std::uint64_t{varying_[0] != nullptr} |
                               std::uint64_t{varying_[1] != nullptr} << 1U | std::uint64_t{is_regular_} << 2U;
  const memory::Arbitration& arbitration = this->arbitration();
  const memory::Port port = control().ports().host();
  const std::uint64_t host =
      arbitration.is_routed(port) && !is_host_routed_
          ? arbitration.bank_of(port) << 2U | std::uint64_t{arbitration.writes(port)} << 1U | 1U
          : 0;
  open_rows_.count(cycle);
  state_words_.clear();
  control().append_state(state_words_);
  arbitration.append_state(cycle, state_words_);
  rows_place_ = state_words_.size();
  open_rows_.append_state(cycle, control().match().columns(), state_words_);
  state_words_.push_back(layout_->number << 32U | host << 3U | varies);
  state_words_.push_back(arbitration.shared());
  state_words_.resize(state_words_.size() + open_rows_.refreshes());  // see refresh_left_
  state_words_.push_back(layout_->areas.number_of(control().match().columns()));
  return known_.number_of(state_words_, [this] { return unhandled(); });
}

}  // namespace stereotlm::fpga
