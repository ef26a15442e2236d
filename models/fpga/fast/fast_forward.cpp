#include "models/fpga/fast/fast_forward.h"

#include <algorithm>
#include <utility>

namespace stereotlm::fpga {
namespace {

// See FastForward::slots_ahead_.
std::uint64_t slots_ahead(const FrameGeometry& geometry, int lane_fifo_slots) {
  if (geometry.lanes == 1) return static_cast<std::uint64_t>(lane_fifo_slots);
  const int fewest = geometry.slots_of_lane(geometry.lanes - 1);  // of a column in a lane
  return static_cast<std::uint64_t>((lane_fifo_slots / fewest + 1) * geometry.slots_per_column);
}

// The number of columns whose slots can have an effect before a group ends, and the one behind.
std::uint64_t columns_ahead(const FrameGeometry& geometry, std::uint64_t slots_ahead) {
  return 4 + slots_ahead / static_cast<std::uint64_t>(geometry.slots_per_column) + 3;
}

// After so many columns, all words that were in the queue before them have been written.
std::uint64_t columns_behind(const CoreConfig& config, const FrameGeometry& geometry) {
  return 4 * static_cast<std::uint64_t>((config.result_fifo_words + geometry.rows) / geometry.last_rows + 1);
}

// The words of the accesses of both sides.
std::size_t words_of_accesses(const FrameGeometry& geometry, std::uint64_t slots_ahead) {
  return 2 * ((4 * static_cast<std::uint64_t>(geometry.slots_per_column) + slots_ahead + 63) / 64);
}

// Of a frame, the drain included.
std::uint64_t columns_of(const FrameGeometry& geometry) {
  return geometry.columns + static_cast<std::uint64_t>(geometry.drain_columns);
}

const memory::SdramTiming* timing_of(const memory::BankArbiter& arbiter) {
  return arbiter.has_rows() ? &arbiter.rows()->timing() : nullptr;
}

std::size_t count_refreshing_banks(const memory::Arbitration& arbitration) {
  std::size_t banks = 0;
  for (std::size_t bank = 0; bank < arbitration.banks(); ++bank) {
    const memory::SdramTiming* const timing = timing_of(arbitration.arbiter(bank));
    banks += timing != nullptr && timing->refresh_interval_cycles ? 1 : 0;
  }
  return banks;
}

static_assert(memory::kBankCountRule.max <= 1 << 6U &&
              2 * memory::kBankCountRule.max - 1 <= HostRequests::kMostRoute);

}  // namespace

FastForward::FastForward(const CoreConfig& config, memory::Arbitration& arbitration)
    : CoreStepper(config, arbitration),
      config_(config),
      slots_ahead_(slots_ahead(control().geometry(), config.lane_fifo_slots)),
      cycles_per_column_(static_cast<std::uint64_t>(control().geometry().cycles_per_column)),
      refreshing_banks_(count_refreshing_banks(arbitration)),
      open_rows_(control().geometry()),
      handled_(control().lanes().size()),
      known_(1 + refreshing_banks_),
      around_(1 + refreshing_banks_ + words_of_accesses(control().geometry(), slots_ahead_)) {
  for (std::size_t lane = 0; lane < handled_.size(); ++lane)
    handled_[lane].slot = control().lane(lane).first_slot();
}

void FastForward::start_direct_frame(const AccessPatterns& patterns) {
  patterns_ = &patterns;
  can_follow_ = false;
  for (const Side side : kSides) {
    const AccessPattern& pattern = patterns[index_of(side)];
    const bool has_table = control().lane(control().lane_index(side, 0)).has_table();
    const bool varies = has_table && !pattern.needs_all_pixels() && !pattern.is_identity();
    varying_[index_of(side)] = varies ? &pattern : nullptr;
  }
  std::fill(around_.begin(), around_.end(), 0);
  if (accesses_vary() && known_.words() < around_.size()) known_.clear(around_.size());
  find_layout();
}

void FastForward::end_direct_frame(std::uint64_t cycle) {
  catch_up(cycle);
  can_follow_ = false;
  if (std::exchange(is_host_routed_, false)) arbitration().unroute(control().ports().host());
}

// Sets layout_ and open_rows_. Buffers lie alike in frames if their parts lie in the same banks, and in sdram
// at the same places among the internal banks.
void FastForward::find_layout() {
  layout_ = nullptr;
  SdramTimings timings;
  for (std::size_t bank = 0; bank < arbitration().banks(); ++bank)
    timings.push_back(arbitration().has_rows() ? timing_of(arbitration().arbiter(bank)) : nullptr);
  std::vector<SdramPart> sdram = sdram_parts(config_, placements(), timings);
  if (!are_apart(sdram) || !follows_from_places()) return;
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
    const bool results_have_places = memory::has(arbitration().placed(), control().ports().result());
    FramePlaces of_layout(config_, columns_ahead(geometry, slots_ahead_),
                          results_have_places ? columns_behind(config_, geometry) : 0, placements(), sdram);
    layout = layouts_.emplace(places, Layout{layouts_.size(), std::move(of_layout)}).first;
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

std::uint64_t FastForward::run_ahead(std::uint64_t cycle, std::uint64_t end) {
  for (;;) {
    cycle = skip_ahead(cycle, end);
    if (cycle >= end || control().frame_done()) break;
    cycle = step_group(cycle, end);
  }
  catch_up(cycle);
  return cycle;
}

std::uint64_t FastForward::skip_ahead(std::uint64_t cycle, std::uint64_t end) {
  while (skip_transition(cycle, end)) {
  }
  return cycle;
}

FastForward::Served FastForward::serve_host(std::uint64_t& cycle, const Route& route, std::uint64_t first,
                                            std::size_t words) {
  route_host(cycle, route);
  if (ConflictRecorder* const conflicts = this->conflicts()) conflicts->set_host_traffic(route.traffic);
  host_ = {first, words, static_cast<std::uint8_t>(route.bank << 1U | std::size_t{route.write}), route.word};
  served_ = {};
  const std::uint64_t end = std::max(cycle, first) + kMostHostCycles;
  while (host_.words != 0 && cycle < end && !control().frame_done()) {
    if (!skip_transition(cycle, end)) cycle = step_group(cycle, end);
  }
  host_.words = 0;
  return served_;
}

// Routes the host to the bank. If a port was alone there until now, the state gets other words.
void FastForward::route_host(std::uint64_t cycle, const Route& route) {
  const bool is_new = !arbitration().is_shared(route.bank);
  if (is_new) catch_up(cycle);
  arbitration().visit(control().ports().host(), route.bank, route.write);
  is_host_routed_ = true;
  if (is_new) set_state(cycle);
}

// Follows the next transition if it is known, or several that are alike. If the host does not request in it,
// it must end before `end`. Returns false if a cycle must be stepped.
bool FastForward::skip_transition(std::uint64_t& cycle, std::uint64_t end) {
  if (!can_follow_ || cycle >= end) return false;
  around_[0] = place_.number;
  if (accesses_vary()) set_accesses();
  const std::uint64_t recorded = next_recorded(cycle);
  const std::uint64_t end_alone = std::min(host_.words == 0 ? end : std::min(end, host_.first), recorded);
  if (end_alone >= cycle + least_cycles()) {
    if (const auto found = find(cycle, {}, end_alone - cycle)) {
      const std::uint64_t times = times_alike(*found, end_alone - cycle);
      follow(*found, cycle, times);
      if (times == 1) follow_loop(*found, cycle, end_alone);
      return true;
    }
  }
  if (host_.words == 0 || host_opens_rows()) return false;
  const auto found = find_with_host(cycle, recorded);
  if (found) follow(*found, cycle, 1);
  loop_.most = 0;
  return found.has_value();
}

// The known transition from `cycle` on with these requests of the host, of `most_cycles` cycles or less. No
// row of results that is recorded may end in it.
std::optional<FastForward::Transition> FastForward::find(std::uint64_t cycle, HostRequests host,
                                                         std::uint64_t most_cycles) {
  auto found = known_.find(state_, around_, host);
  if (refresh_left_ != UINT64_MAX && (!found || known_.progress(*found).cycles > refresh_left_)) {
    set_refreshes(cycle);
    found = known_.find(state_, around_, host);
    std::fill_n(around_.begin() + 1, refreshing_banks_, 0);
  }
  if (!found) return std::nullopt;
  const Progress& progress = known_.progress(*found);
  return progress.cycles <= most_cycles && progress.words <= most_words() ? found : std::nullopt;
}

// The known transition from `cycle` on in which the host requests host_, if it ends before `end`.
std::optional<FastForward::Transition> FastForward::find_with_host(std::uint64_t cycle, std::uint64_t end) {
  const std::optional<HostRequests> requests = requests_of(host_, cycle);
  if (!requests) return std::nullopt;
  if (const auto found = find(cycle, *requests, end - cycle)) return found;
  const auto found = find(cycle, {requests->first, HostRequests::kEndless, requests->route}, end - cycle);
  return found && known_.host(*found).words < host_.words ? found : std::nullopt;
}

// The requests of these words from `cycle` on. Nothing if the cache cannot hold them.
std::optional<HostRequests> FastForward::requests_of(const HostWords& host, std::uint64_t cycle) {
  const std::uint64_t first = host.first > cycle ? host.first - cycle : 0;
  if (first > HostRequests::kMostCycles) return std::nullopt;
  return HostRequests{static_cast<std::uint16_t>(first),
                      static_cast<std::uint16_t>(std::min<std::size_t>(host.words, HostRequests::kEndless)),
                      host.route};
}

// Whether the words of the host lie in sdram. Their rows are no part of a state.
bool FastForward::host_opens_rows() const {
  return arbitration().arbiter(arbitration().bank_of(control().ports().host())).has_rows();
}

// The first cycle from this one on that a CycleRecorder needs.
std::uint64_t FastForward::next_recorded(std::uint64_t cycle) const {
  return cycles() == nullptr ? UINT64_MAX : cycles()->next_stepped(cycle);
}

// How often a transition comes in a row within `most_cycles` cycles: more than once if it leads to its own
// state, and its surroundings stay alike. Without waits this is almost a whole strip.
std::uint64_t FastForward::times_alike(const Transition& transition, std::uint64_t most_cycles) const {
  if (transition.next != state_) return 1;
  const Progress& progress = known_.progress(transition);
  std::uint64_t most =
      std::min(std::min(most_cycles, refresh_left_) / progress.cycles, (place_.end - column_ + 3) / 4);
  if (progress.words != 0) most = std::min(most, most_words() / progress.words);
  most = std::max<std::uint64_t>(most, 1);
  const FrameGeometry& geometry = control().geometry();
  if (!accesses_vary() || column_ >= geometry.columns) return most;
  if (group_end_ >= geometry.columns) return 1;
  most = std::min(most, 1 + (geometry.columns - group_end_) / 4);
  const std::size_t words = (around_.size() - 1 - refreshing_banks_) / 2;
  const auto per_column = static_cast<std::uint64_t>(geometry.slots_per_column);
  const std::uint64_t in_use = group_end_ * per_column - slots_consumed() + slots_ahead_;
  // Whether the slots that are in the lanes from slot `first` on have the accesses of this group.
  const auto has_accesses = [&](std::uint64_t first) {
    const std::uint64_t* of_side = around_.data() + 1 + refreshing_banks_;
    for (const AccessPattern* const pattern : varying_) {
      for (std::size_t word = 0; pattern != nullptr && 64 * word < in_use; ++word) {
        const std::uint64_t unused = 64 * (word + 1) > in_use ? ~std::uint64_t{0} << in_use % 64 : 0;
        if ((pattern->pixels_of_slots(first + 64 * word) & ~unused) != of_side[word]) return false;
      }
      of_side += words;
    }
    return true;
  };
  std::uint64_t times = 1;
  while (times < most && has_accesses(slots_consumed() + 4 * per_column * times)) ++times;
  return times;
}

// Follows a transition from `cycle` on, and sets `cycle` to the next cycle.
void FastForward::follow(const Transition& transition, std::uint64_t& cycle, std::uint64_t times) {
  if (conflicts() != nullptr) replay(transition, cycle, times);
  const Progress& progress = known_.progress(transition);
  const HostGrants& host = known_.host(transition);
  const std::uint64_t cycles = progress.cycles * times;
  if (host.requests != 0) {
    if (host.words != 0) served_.last_cycle = cycle + host.cycles - 1;
    served_.words += host.words;
    host_.words -= host.words;
    host_.first = cycle + cycles;
  }
  known_.follow(transition, times);
  cycle += cycles;
  ahead_.add(progress, times);
  skipped_cycles_ += cycles;
  state_ = transition.next;
  consumed_ += progress.consumed * times;
  column_ += (times - 1) * 4;
  group_end_ += (times - 1) * 4;
  if (consumed_ == group_end_ * cycles_per_column_) {
    column_ = group_end_;
    group_end_ += 4;
  } else {
    column_ = consumed_ / cycles_per_column_;
  }
  if (column_ == columns_of(control().geometry())) {
    can_follow_ = false;
  } else if (column_ >= place_.end) {
    place_ = layout_->places.at(column_);
  }
  if (refresh_left_ == UINT64_MAX) return;
  if (cycles > refresh_left_) {
    set_refresh_left(cycle);
    loop_.most = 0;  // a refresh does not come again with it
  } else {
    refresh_left_ -= cycles;
  }
}

// To be called behind a transition that was followed once, `last`. If it closes a loop, follows the loop as
// often as it comes again before `end`. Contended ports have such loops of a few groups.
void FastForward::follow_loop(const Transition& last, std::uint64_t& cycle, std::uint64_t end) {
  if (!can_follow_ || accesses_vary()) return;
  std::vector<Transition>& loop = loop_.transitions;
  const bool is_open = loop_.most != 0 && place_.number == loop_.place;
  if (is_open) loop.push_back(last);
  if (!is_open || (state_ != loop_.from && loop.size() == loop_.most)) {
    loop_.most = is_open ? std::min(2 * loop_.most, Loop::kMost) : 1;
    loop_.from = state_;
    loop_.place = place_.number;
    loop.clear();
    return;
  }
  if (state_ != loop_.from) return;
  Progress progress;
  for (const Transition& transition : loop) progress.add(known_.progress(transition));
  std::uint64_t times = std::min(std::min(end - cycle, refresh_left_) / progress.cycles,
                                 (place_.end - column_ + 3) / (4 * loop.size()));
  if (progress.words != 0) times = std::min(times, most_words() / progress.words);
  const std::uint64_t at_once = conflicts() == nullptr ? times : 1;  // a recorder hears them in their order
  for (; times > 0; times -= at_once) {
    for (const Transition& transition : loop) follow(transition, cycle, at_once);
  }
  loop_.most = 0;
}

// Tells the recorder of conflicts what happens in a transition from `cycle` on.
void FastForward::replay(const Transition& transition, std::uint64_t cycle, std::uint64_t times) const {
  const Progress& progress = known_.progress(transition);
  const bool ends_group = consumed_ + progress.consumed == group_end_ * cycles_per_column_;
  for (; times > 0; --times) {
    cycle += progress.cycles;
    for (const memory::BankUse& use : known_.bank_uses(transition))
      conflicts()->hear(use.port, arbitration().bank_of(use), use.by, use.cycles);
    if (ends_group) conflicts()->end_group(cycle);
  }
}

// Takes the core and the arbiters to the state that the transitions have led to.
void FastForward::catch_up(std::uint64_t cycle) {
  if (ahead_.cycles == 0) return;
  CoreControl& control = this->control();
  known_.count_followed(control, arbitration());
  memory::StateReader state = known_.state(state_).begin();
  control.set_state(state, ahead_.consumed, ahead_.words);
  for (std::size_t lane = 0; lane < control.lanes().size(); ++lane) control.set_marks(lane, marks(lane));
  arbitration().set_state(cycle, state);
  open_rows_.set_state(cycle, control.match().columns(), state);
  ahead_ = {};
}

// LaneControl::set_marks() of a lane.
std::uint64_t FastForward::marks(std::size_t number) const {
  const LaneControl& lane = control().lane(number);
  if (!lane.has_table() || lane.handled() == lane.taken()) return 0;
  std::uint64_t marks = 0;
  SlotCursor slot = lane.first_slot();
  slot.advance(lane.handled());
  for (std::uint64_t mark = 1, left = lane.taken() - lane.handled(); left > 0; --left, mark <<= 1U) {
    if (!slot.empty() && accesses_pixel(number, slot)) marks |= mark;
    slot.advance();
  }
  return marks;
}

// Steps to the end of the group or of the host's burst, but not beyond `end` or the end of the frame. Records
// the transition if it is whole.
std::uint64_t FastForward::step_group(std::uint64_t cycle, std::uint64_t end) {
  catch_up(cycle);
  std::optional<Stepped> stepped;
  if (can_follow_) {
    set_refreshes(cycle);
    stepped = {state_, around_, refresh_left_, host_, progress(cycle), control().counts()};
    std::fill_n(around_.begin() + 1, refreshing_banks_, 0);
    arbitration().begin_recording();
  }
  can_follow_ = false;
  bool burst_ends = false;
  do {
    burst_ends = step_cycle(cycle++);
    if (!burst_ends) cycle = skip_waiting(cycle, host_.words == 0 ? end : std::min(end, host_.first));
  } while (!burst_ends && !completed_group() && cycle < end && !control().frame_done());
  if (!burst_ends && !completed_group()) return cycle;
  if (known_.is_full()) {
    known_.clear(known_.words());
    stepped.reset();
  }
  set_state(cycle);
  if (stepped && can_follow_) record_stepped(*stepped, cycle);
  return cycle;
}

// Returns whether the burst of the host ends in the cycle.
bool FastForward::step_cycle(std::uint64_t cycle) {
  const memory::Port port = control().ports().host();
  const bool requests = host_.words != 0 && cycle >= host_.first;
  if (requests && memory::has(arbitration().placed(), port))
    arbitration().place(port, arbitration().bank_of(port), host_.word);
  const memory::PortMask granted = step(
      cycle, requests,
      [this](const CoreControl::Decision& /*decision*/, memory::PortMask ports) {
        return needs_pixel(ports);
      },
      [this](std::size_t lane) { return next_entry(lane); });
  if (!memory::has(granted, port)) return false;
  ++served_.words;
  served_.last_cycle = cycle;
  ++host_.word;
  host_.first = cycle + 1;
  return --host_.words == 0;
}

PixelNeeds FastForward::needs_pixel(memory::PortMask granted) const {
  PixelNeeds needs = 0;
  for (std::size_t lane = 0; lane < control().lanes().size(); ++lane) {
    if (memory::has(granted, control().table_port(lane)) &&
        accesses_pixel(lane, control().lane(lane).next_slot()))
      needs |= PixelNeeds{1} << lane;
  }
  return needs;
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

// Skips the cycles before `end` in which everything waits for the matcher. Returns the next cycle.
std::uint64_t FastForward::skip_waiting(std::uint64_t cycle, std::uint64_t end) {
  end = std::min(end, next_recorded(cycle));
  if (end <= cycle) return cycle;
  const std::uint64_t cycles = std::min(end - cycle, control().waiting_cycles());
  if (cycles != 0) control().skip_waiting(cycles);
  skipped_cycles_ += cycles;
  return cycle + cycles;
}

// Records the transition that has just been stepped, up to `cycle`.
void FastForward::record_stepped(const Stepped& stepped, std::uint64_t cycle) {
  TransitionCache::Effect effect{progress(cycle).since(stepped.begin),
                                 CoreControl::difference(control().counts(), stepped.counts),
                                 arbitration().take_recorded(),
                                 {}};
  HostRequests requests;
  if (stepped.host.words != 0 && stepped.host.first < cycle) {  // the host has requested
    const std::optional<HostRequests> host = requests_of(stepped.host, stepped.begin.cycles);
    if (!host || effect.progress.cycles > HostRequests::kMostCycles || host_opens_rows()) return;
    requests = *host;
    const std::uint64_t end = host_.words != 0 ? cycle : host_.first;  // of the requests
    effect.host.words = stepped.host.words - host_.words;
    effect.host.requests = end - stepped.begin.cycles - requests.first;
    if (effect.host.words != 0) effect.host.cycles = host_.first - stepped.begin.cycles;
    if (host_.words != 0) requests.words = HostRequests::kEndless;
  }
  TransitionCache::Surroundings around = stepped.around;
  if (effect.progress.cycles <= stepped.refresh_left) std::fill_n(around.begin() + 1, refreshing_banks_, 0);
  known_.record(stepped.state, around, requests, state_, effect, arbitration());
}

// Finds the state before `cycle`, to which the core has been stepped.
void FastForward::set_state(std::uint64_t cycle) {
  can_follow_ = false;
  column_ = control().match().columns();
  consumed_ = control().match().consumed();
  if (layout_ == nullptr || column_ == columns_of(control().geometry())) return;
  can_follow_ = true;
  group_end_ = (consumed_ + control().match().cycles_of_group_left()) / cycles_per_column_;
  place_ = layout_->places.at(column_);
  open_rows_.count(cycle);
  state_words_.clear();
  control().append_state(state_words_);
  arbitration().append_state(cycle, state_words_);
  rows_word_ = state_words_.size();
  open_rows_.append_state(cycle, column_, state_words_);
  std::uint64_t kinds = 0;  // of the accesses of each side
  for (std::size_t side = 0; side < varying_.size(); ++side) {
    const std::uint64_t kind = varying_[side] != nullptr ? 2 : (*patterns_)[side].needs_all_pixels() ? 1 : 0;
    kinds |= kind << 2 * side;
  }
  state_words_.push_back(layout_->number << 32U | kinds);
  state_words_.push_back(arbitration().shared());
  state_ = known_.number_of(state_words_, [this] { return mask_of_state(); });
  loop_.most = 0;
  set_refresh_left(cycle);
}

// Sets refresh_left_ for the state before `cycle`.
void FastForward::set_refresh_left(std::uint64_t cycle) {
  refresh_left_ = UINT64_MAX;
  const auto rows = known_.state(state_).begin() + static_cast<std::ptrdiff_t>(rows_word_);
  for (const std::int64_t left : open_rows_.refreshes(cycle, rows))
    refresh_left_ = std::min(refresh_left_, static_cast<std::uint64_t>(std::max(left, std::int64_t{0})));
}

// Sets the cycles to the refreshes in around_, none of which is 0 then.
void FastForward::set_refreshes(std::uint64_t cycle) {
  if (refresh_left_ == UINT64_MAX) return;
  const auto rows = known_.state(state_).begin() + static_cast<std::ptrdiff_t>(rows_word_);
  auto word = around_.begin() + 1;
  for (const std::int64_t left : open_rows_.refreshes(cycle, rows))
    *word++ = static_cast<std::uint64_t>(2 * left + 1);
}

// The number of slots of a side that the matcher has consumed.
std::uint64_t FastForward::slots_consumed() const {
  const FrameGeometry& geometry = control().geometry();
  const auto slots = static_cast<std::uint64_t>(geometry.slots_per_column);
  const std::uint64_t cycles = consumed_ - column_ * cycles_per_column_;
  return column_ * slots + std::min(cycles * static_cast<std::uint64_t>(geometry.lanes), slots);
}

// Sets the accesses in around_: of all slots that can be in the lanes up to the end of the group. A bit is 1
// if the slot accesses its pixel.
void FastForward::set_accesses() {
  const FrameGeometry& geometry = control().geometry();
  const std::size_t first_word = 1 + refreshing_banks_;
  const std::size_t words = (around_.size() - first_word) / 2;
  const std::uint64_t first = slots_consumed();
  std::fill(around_.begin() + static_cast<std::ptrdiff_t>(first_word), around_.end(), 0);
  if (column_ >= geometry.columns) return;
  const auto per_column = static_cast<std::uint64_t>(geometry.slots_per_column);
  const std::uint64_t in_use = std::min(group_end_ * per_column, geometry.slots) - first + slots_ahead_;
  for (std::size_t side = 0; side < varying_.size(); ++side) {
    if (varying_[side] == nullptr) continue;
    std::uint64_t* const of_side = around_.data() + first_word + side * words;
    for (std::size_t word = 0; 64 * word < in_use; ++word)
      of_side[word] = varying_[side]->pixels_of_slots(first + 64 * word);
    if (in_use % 64 != 0) of_side[in_use / 64] &= (std::uint64_t{1} << in_use % 64) - 1;
  }
}

// See TransitionCache::number_of(): the slots that are handled have no effect.
TransitionCache::Surroundings FastForward::mask_of_state() const {
  TransitionCache::Surroundings mask(around_.size(), ~std::uint64_t{0});
  const FrameGeometry& geometry = control().geometry();
  const std::size_t first_word = 1 + refreshing_banks_;
  const std::size_t bits = 64 * (mask.size() - first_word) / 2;  // of a side
  const std::uint64_t first = slots_consumed();
  for (std::size_t lane = 0; lane < control().lanes().size(); ++lane) {
    const LaneControl& of_lane = control().lane(lane);
    const std::size_t number = lane % control().ports().lanes();
    const auto slots = static_cast<std::uint64_t>(geometry.slots_of_lane(static_cast<int>(number)));
    for (std::uint64_t slot = of_lane.handled() - of_lane.handled_slots(); slot < of_lane.handled(); ++slot) {
      const std::uint64_t of_side = slot / slots * static_cast<std::uint64_t>(geometry.slots_per_column) +
                                    slot % slots * control().ports().lanes() + number;
      const std::size_t bit = index_of(control().side_of(lane)) * bits + of_side - first;
      mask[first_word + bit / 64] &= ~(std::uint64_t{1} << bit % 64);
    }
  }
  return mask;
}

}  // namespace stereotlm::fpga
