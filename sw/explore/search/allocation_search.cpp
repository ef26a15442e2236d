#include "sw/explore/search/allocation_search.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>

#include "models/memory/arbitration_policies.h"
#include "platform/config/buffer_layout.h"
#include "sw/explore/store/store.h"

namespace stereotlm::explore {
namespace {

using platform::BankConfig;
using platform::BoardConfig;
using platform::PlacedBuffer;

bool are_alike(const BankConfig& a, const BankConfig& b) {
  return a.words == b.words && a.kind == b.kind && a.turnaround_cycles == b.turnaround_cycles &&
         a.sdram == b.sdram;
}

// The largest number of boards that next() returns for each number of banks. It is large enough to keep the
// processors busy. It is small enough that most runs start after the results that can leave them out.
constexpr std::uint64_t kBoardsPerRound = 8;

// Relative tolerance in comparisons of a bound with a rate, which are both rounded quotients.
constexpr double kRounding = 1e-9;

bool reaches(double rate, double rate_to_reach) { return rate >= rate_to_reach * (1 - kRounding); }

// The banks of all buffers in one text, as a key.
std::string key_of(const platform::BoardConfig& board) {
  std::string key;
  for (const platform::PlacedBuffer& buffer : platform::buffers(board)) key += buffer.bank + ' ';
  return key;
}

// Reads the results of some boards from the database, and records them in the search. If the sweep of the
// boards is whole, a board that is not in the database was given up.
void record_outcomes(const std::vector<std::size_t>& numbers, const std::string& path, bool is_whole,
                     AllocationSearch& search) {
  StoredRow row(path);
  for (const std::size_t number : numbers) {
    const Point point = search.point(number);
    if (!row.find(point.hash)) {
      if (is_whole) search.record_given_up(number);
      continue;
    }
    AllocationOutcome outcome;
    if (row.text("status") != "ok") {
      outcome.failure = row.text("reason");
      search.record(number, outcome);
      continue;
    }
    const auto behind_last_write = static_cast<std::uint64_t>(point.board->fpga.pipeline_latency_cycles);
    outcome.cycles = static_cast<std::uint64_t>(row.integer("cycles")) + point.run.frames * behind_last_write;
    outcome.frames_per_second =
        row.real(search.run().camera ? "frames_per_second.steady" : "frames_per_second.core");
    outcome.uncertainty = row.real("frames_per_second.steady_uncertainty");
    outcome.loses_pixels = row.lost_pixels() > 0;
    search.record(number, outcome);
  }
}

}  // namespace

int banks_used(const Placement& placement) {
  return static_cast<int>(std::set<int>(placement.begin(), placement.end()).size());
}

bool fits(const BoardConfig& board, const Placement& placement) {
  std::vector<std::uint64_t> words(board.banks.size());
  const std::vector<PlacedBuffer> buffers = platform::buffers(board);
  for (std::size_t i = 0; i < buffers.size(); ++i) {
    words[static_cast<std::size_t>(placement[i])] += platform::buffer_words(buffers[i], board.image);
  }
  for (std::size_t bank = 0; bank < words.size(); ++bank) {
    if (words[bank] > static_cast<std::uint64_t>(board.banks[bank].words)) return false;
  }
  return true;
}

void for_each_placement(const BoardConfig& board, int most_banks,
                        const std::function<void(const Placement&)>& visit) {
  const std::size_t buffers = platform::buffers(board).size();
  std::vector<int> used(board.banks.size());  // [bank]: number of buffers in it
  int banks = 0;                              // number of banks with buffers
  Placement placement;
  // Whether no unused bank before `bank` is like it.
  const auto is_first_of_its_kind = [&](std::size_t bank) {
    for (std::size_t other = 0; other < bank; ++other) {
      if (used[other] == 0 && are_alike(board.banks[other], board.banks[bank])) return false;
    }
    return true;
  };
  const auto place_next = [&](const auto& self) -> void {
    if (placement.size() == buffers) return visit(placement);
    for (std::size_t bank = 0; bank < board.banks.size(); ++bank) {
      if (used[bank] == 0 && (banks == most_banks || !is_first_of_its_kind(bank))) continue;
      if (used[bank]++ == 0) ++banks;
      placement.push_back(static_cast<int>(bank));
      self(self);
      placement.pop_back();
      if (--used[bank] == 0) --banks;
    }
  };
  place_next(place_next);
}

BoardConfig placed(const BoardConfig& board, const Placement& placement) {
  BoardConfig result = board;
  const std::vector<PlacedBuffer> buffers = platform::buffers(board);
  for (std::size_t i = 0; i < buffers.size(); ++i) {
    const BankConfig& bank = board.banks[static_cast<std::size_t>(placement[i])];
    platform::move_buffer(result, buffers[i], bank.name);
  }
  return result;
}

bool frames_are_independent(const BoardConfig& board) {
  return memory::find_arbitration_policy(board.fpga.arbiter.policy)->forgets &&
         std::none_of(board.banks.begin(), board.banks.end(),
                      [](const BankConfig& bank) { return bank.turnaround_cycles > 0 || bank.sdram; });
}

BoardConfig board_of_frame(const BoardConfig& board, const Placement& placement, std::uint64_t frame) {
  BoardConfig result = board;
  result.name = "one frame of " + board.name;
  std::map<int, std::string> replacements;
  std::set<std::string> given;
  const auto replacement = [&](int bank) {
    std::string& name = replacements[bank];
    for (const BankConfig& other : board.banks) {
      if (!name.empty()) break;
      const bool is_alike = are_alike(other, board.banks[static_cast<std::size_t>(bank)]);
      if (is_alike && given.insert(other.name).second) name = other.name;
    }
    return name;
  };
  std::size_t first = 0;  // index in the placement of the list's first buffer, or of the table
  platform::AllocationConfig& allocation = result.allocation;
  for (auto* list : {&allocation.left_image, &allocation.right_image, &allocation.disparity}) {
    const std::size_t length = list->size();
    *list = {replacement(placement[first + frame % length])};
    first += length;
  }
  for (auto* table : {&allocation.left_lut, &allocation.right_lut}) {
    if (*table && first < placement.size()) *table = replacement(placement[first++]);
  }
  if (board.fpga.joint_tables) allocation.right_lut = allocation.left_lut;
  return result;
}

std::string allocation_text(const platform::BoardConfig& board) {
  std::string text;
  std::optional<platform::Buffer> last;
  for (const PlacedBuffer& buffer : platform::buffers(board)) {
    if (buffer.buffer != last) text += (text.empty() ? "" : ", ") + std::string(name_of(buffer.buffer));
    text += ' ' + platform::bank_text(buffer.bank);
    last = buffer.buffer;
  }
  return text;
}

AllocationSearch::AllocationSearch(const platform::BoardConfig& board, int most_banks, const PointRun& run,
                                   const BoundOf& bound, const Watch& watch)
    : board_(board),
      run_(run),
      by_frames_(!run.camera && frames_are_independent(board)),
      turn_frames_(platform::allocation_period_frames(board)) {
  for_each_placement(board, most_banks, [this](const Placement& /*placement*/) {
    if (++placements_ > kMostPlacements)
      throw std::length_error(fmt::format("more than {} different allocations", kMostPlacements));
  });
  std::uint64_t visited = 0;
  std::map<std::string, std::size_t> numbers;  // [key_of(board)]: index of frame_boards_
  for_each_placement(board, most_banks, [&](const Placement& placement) {
    watch(visited++, placements_);
    if (!fits(board_, placement)) return;
    fitting_.push_back(placement);
    for (std::uint64_t frame = 0; by_frames_ && frame < turn_frames_; ++frame) {
      platform::BoardConfig one = board_of_frame(board_, placement, frame);
      const auto [known, is_new] = numbers.emplace(key_of(one), frame_boards_.size());
      frame_numbers_.push_back(known->second);
      if (is_new) frame_boards_.push_back(std::move(one));
    }
  });
  outcomes_.resize(by_frames_ ? frame_boards_.size() : fitting_.size());
  given_up_.resize(outcomes_.size());
  order_.resize(outcomes_.size());
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  if (by_frames_) return;
  for (const Placement& placement : fitting_) {
    watch(bounds_.size(), fitting_.size());
    bounds_.push_back(bound(placed(board_, placement)));
  }
  std::stable_sort(order_.begin(), order_.end(),
                   [this](std::size_t a, std::size_t b) { return bounds_[a] > bounds_[b]; });
}

Point AllocationSearch::point(std::size_t number) const {
  if (by_frames_) return make_point(number, frame_boards_.at(number), {false, 1, run_.calibration});
  return make_point(number, placed(board_, fitting_.at(number)), run_);
}

void AllocationSearch::record(std::size_t number, const AllocationOutcome& outcome) {
  if (!by_frames_ && !outcome.loses_pixels &&
      !reaches(bounds_[number], outcome.frames_per_second - outcome.uncertainty)) {
    throw std::logic_error(fmt::format("{}: {} ± {} frames/s, above its bound of {}",
                                       allocation_text(*point(number).board), outcome.frames_per_second,
                                       outcome.uncertainty, bounds_[number]));
  }
  outcomes_.at(number) = outcome;
}

std::vector<std::size_t> AllocationSearch::left() const {
  const auto to_reach = by_frames_ ? std::map<int, double>() : rates_to_reach(rated());
  std::vector<std::size_t> numbers;
  for (const std::size_t number : order_) {
    if (!outcomes_[number] && !given_up_[number] && (by_frames_ || may_tie(number, to_reach)))
      numbers.push_back(number);
  }
  return numbers;
}

std::vector<std::size_t> AllocationSearch::next() const {
  std::vector<std::size_t> numbers = left();
  std::map<int, std::uint64_t> taken;
  const auto is_for_later = [&](std::size_t number) {
    return taken[banks_used(fitting_[number])]++ >= kBoardsPerRound;
  };
  if (!by_frames_) numbers.erase(std::remove_if(numbers.begin(), numbers.end(), is_for_later), numbers.end());
  return numbers;
}

double AllocationSearch::rate_to_reach(std::size_t number) const {
  if (by_frames_) return 0;
  const std::map<int, double> to_reach = rates_to_reach(rated());
  const auto rate = to_reach.find(banks_used(fitting_.at(number)));
  return rate == to_reach.end() ? 0 : rate->second * (1 - kRounding);
}

std::vector<AllocationSearch::Rated> AllocationSearch::rated() const {
  std::vector<Rated> all;
  for (std::size_t place = 0; place < fitting_.size(); ++place) {
    const std::optional<AllocationOutcome> outcome = outcome_of(place);
    if (!outcome || outcome->loses_pixels || !outcome->failure.empty()) continue;
    const double most = outcome->frames_per_second + outcome->uncertainty;
    all.push_back({place, banks_used(fitting_[place]), *outcome,
                   outcome->frames_per_second - outcome->uncertainty,
                   by_frames_ ? most : std::min(most, bounds_[place])});
  }
  return all;
}

std::map<int, double> AllocationSearch::rates_to_reach(const std::vector<Rated>& rated) {
  std::map<int, double> rates;
  for (const Rated& one : rated) {
    double& rate = rates[one.banks];
    rate = std::max(rate, one.least);
  }
  return rates;
}

bool AllocationSearch::may_tie(std::size_t placement, const std::map<int, double>& rates_to_reach) const {
  const auto rate = rates_to_reach.find(banks_used(fitting_[placement]));
  return rate == rates_to_reach.end() || reaches(bounds_[placement], rate->second);
}

std::optional<AllocationOutcome> AllocationSearch::outcome_of(std::size_t placement) const {
  if (!by_frames_) return outcomes_[placement];
  AllocationOutcome sum;
  for (std::uint64_t frame = 0; frame < turn_frames_; ++frame) {
    const auto& one = outcomes_.at(frame_numbers_[placement * turn_frames_ + frame]);
    if (!one || !one->failure.empty()) return one;
    sum.cycles += one->cycles;
  }
  sum.frames_per_second =
      board_.fpga.clock_mhz * 1e6 * static_cast<double>(turn_frames_) / static_cast<double>(sum.cycles);
  sum.cycles *= frames_of(run_, board_) / turn_frames_;
  return sum;
}

std::vector<BestPlacement> AllocationSearch::best() const {
  std::map<int, BestPlacement> found;
  for (std::size_t place = 0; place < fitting_.size(); ++place) {
    BestPlacement& best = found[banks_used(fitting_[place])];
    best.banks = banks_used(fitting_[place]);
    ++best.placements;
    if (!by_frames_ && given_up_[place]) ++best.given_up;
    const std::optional<AllocationOutcome> outcome = outcome_of(place);
    if (!outcome) continue;
    ++best.known;
    if (outcome->loses_pixels || !outcome->failure.empty())
      ++(outcome->failure.empty() ? best.losing : best.failed);
  }
  const std::vector<Rated> all_rated = rated();
  const std::map<int, double> to_reach = rates_to_reach(all_rated);
  for (const Rated& one : all_rated) {
    if (!reaches(one.most, to_reach.at(one.banks))) continue;
    BestPlacement& best = found.at(one.banks);
    if (best.tied++ > 0 && one.outcome.frames_per_second <= best.outcome.frames_per_second) continue;
    best.outcome = one.outcome;
    best.witness = fitting_[one.place];
  }
  std::vector<BestPlacement> all;
  for (const auto& [banks, best] : found) all.push_back(best);
  return all;
}

std::optional<BestOfAll> AllocationSearch::best_of_all() const {
  const std::vector<Rated> all = rated();
  if (all.empty()) return std::nullopt;
  double to_reach = 0;
  for (const auto& [banks, rate] : rates_to_reach(all)) to_reach = std::max(to_reach, rate);
  BestOfAll best;
  for (const Rated& one : all) {
    if (!reaches(one.most, to_reach)) continue;
    const double rate = one.outcome.frames_per_second;
    best.possible_frames_per_second = std::max({best.possible_frames_per_second, one.most, rate});
    if (best.tied == 0 || rate > best.highest.frames_per_second) best.highest = one.outcome;
    if (best.tied++ > 0 &&
        std::pair(one.banks, -rate) >= std::pair(best.banks, -best.outcome.frames_per_second))
      continue;
    best.banks = one.banks;
    best.outcome = one.outcome;
    best.witness = fitting_[one.place];
  }
  return best;
}

std::map<int, double> AllocationSearch::open_bounds(const BoundOf& bound) const {
  const std::map<int, double> to_reach = rates_to_reach(rated());
  std::map<int, double> open;
  for (std::size_t place = 0; place < fitting_.size(); ++place) {
    const std::optional<AllocationOutcome> outcome = outcome_of(place);
    const bool is_settled =
        outcome ? outcome->failure.empty() : !by_frames_ && (given_up_[place] || !may_tie(place, to_reach));
    if (is_settled) continue;
    double& most = open[banks_used(fitting_[place])];
    most = std::max(most, by_frames_ ? bound(placed(board_, fitting_[place])) : bounds_[place]);
  }
  return open;
}

std::string AllocationSearch::first_failure() const {
  for (std::size_t number = 0; number < outcomes_.size(); ++number) {
    if (!outcomes_[number] || outcomes_[number]->failure.empty()) continue;
    return fmt::format("{}: {}", allocation_text(*point(number).board), outcomes_[number]->failure);
  }
  return "";
}

bool simulate(AllocationSearch& search, const Evaluate& evaluate, const SweepOptions& sweep,
              const std::function<bool(const SearchProgress& progress)>& keep_going) {
  SearchProgress before;
  before.is_narrowed = search.by_frames();
  for (auto numbers = search.next(); !numbers.empty(); numbers = search.next()) {
    const std::uint64_t left = search.most_left();
    const auto progress_of = [&](const SweepCounts& counts) {
      return SearchProgress{before.done + counts.done(), before.simulated + counts.done() - counts.known,
                            left - counts.done(), before.is_narrowed};
    };
    const auto counts = explore::sweep(
        {numbers.size(), [&](std::uint64_t i) { return search.point(numbers.at(i)); }}, evaluate, sweep,
        [&](const SweepCounts& running) { return keep_going(progress_of(running)); });
    const bool is_whole = counts.done() == counts.total;
    // Without a point the database has no columns of figures.
    if (counts.done() > 0) record_outcomes(numbers, sweep.store, is_whole, search);
    if (!is_whole) return false;
    before = progress_of(counts);
    before.is_narrowed = true;
  }
  return true;
}

}  // namespace stereotlm::explore
