#include "tests/support/plain_cycle_loop.h"

#include <algorithm>
#include <deque>
#include <stdexcept>
#include <string>

namespace stereotlm::test {
namespace {

// Absolute cycles, counted from the first cycle of frame 0.
using Cycle = std::int64_t;

enum class Direction { kRead, kWrite };

// What a port wants in a cycle, decided from the state at the beginning of that cycle. Every port is in one
// of these; kAccess becomes granted or stalled, the others are port states as they stand.
enum class Wish { kIdle, kBlocked, kStarved, kPass, kAccess };

std::size_t index_of(PlainPort port) { return static_cast<std::size_t>(port); }

int read_latency(PlainBankKind kind) { return kind == PlainBankKind::kZbtFlowThrough ? 1 : 2; }

// One bank, its arbiter, and what both remember from frame to frame.
class BankAndArbiter {
 public:
  BankAndArbiter(const PlainBank& bank, const PlainCycleInput& input)
      : bank_(bank), arbitration_(input.arbitration), priority_(input.priority) {}

  // The winner among the ports that request this bank; nullopt if none does.
  std::optional<PlainPort> winner(const std::array<bool, kPlainPortCount>& requests) const {
    std::size_t first = 0;
    if (arbitration_ == PlainArbitration::kRoundRobin && last_granted_) {
      const auto found = std::find(priority_.begin(), priority_.end(), *last_granted_);
      first = static_cast<std::size_t>(found - priority_.begin()) + 1;
    }
    for (std::size_t step = 0; step < kPlainPortCount; ++step) {
      const PlainPort port = priority_[(first + step) % kPlainPortCount];
      if (requests[index_of(port)]) return port;
    }
    return std::nullopt;
  }

  // Whether an access in this direction may not be granted yet because of one in the other direction.
  bool is_turning_round(Direction direction, Cycle now) const {
    if (bank_.kind != PlainBankKind::kSyncBurst) return false;
    const std::optional<Cycle>& other = direction == Direction::kRead ? last_write_ : last_read_;
    return other && now < *other + bank_.turnaround_cycles + 1;
  }

  void grant(PlainPort port, Direction direction, Cycle now) {
    last_granted_ = port;
    (direction == Direction::kRead ? last_read_ : last_write_) = now;
  }

 private:
  PlainBank bank_;
  PlainArbitration arbitration_;
  std::array<PlainPort, kPlainPortCount> priority_;
  std::optional<PlainPort> last_granted_;
  std::optional<Cycle> last_read_;
  std::optional<Cycle> last_write_;
};

// The rectified pixel that a slot is for; the row may be outside the image.
struct Slot {
  int column = 0;
  int row = 0;
};

std::vector<Slot> slots_of_a_frame(const PlainCycleInput& input) {
  const int n = input.window;
  const int r = (n - 1) / 2;
  const int h = input.filter_half;
  std::vector<Slot> slots;
  if (input.fetch == PlainFetch::kColumn) {
    const int w = std::max(0, h - r);
    for (int v = -w; v <= input.height - 1; ++v) {
      for (int u = 0; u <= input.width - 1; ++u) {
        for (int k = 0; k <= n - 1; ++k) slots.push_back({u, v + h - r + k});
      }
    }
  } else {
    for (int y = 0; y <= input.height + r + h - 1; ++y) {
      for (int u = 0; u <= input.width - 1; ++u) slots.push_back({u, y});
    }
  }
  return slots;
}

// One side of the core during one frame.
class Lane {
 public:
  struct Setting {
    bool has_table = false;
    const std::vector<std::uint32_t>* entries = nullptr;  // of the table; null: all valid
    int table_latency = 0;                                // read latency of the table's bank
    int image_latency = 0;                                // read latency of the bank of this frame's image
  };

  Lane(const PlainCycleInput& input, const std::vector<Slot>& sequence, const Setting& setting)
      : width_(input.width),
        height_(input.height),
        lane_fifo_slots_(static_cast<std::size_t>(input.lane_fifo_slots)),
        sequence_(sequence),
        setting_(setting) {}

  Wish lut_port_wish() const { return setting_.has_table ? wish_of_taker() : Wish::kIdle; }

  Wish pixel_port_wish(Cycle now) const {
    if (!setting_.has_table) return wish_of_taker();
    if (handled_ == sequence_.size()) return Wish::kIdle;  // after its last slot
    const bool can_handle =
        handled_ < taken_ && now >= in_lane_[handled_ - consumed_].taken_at + setting_.table_latency;
    if (!can_handle) return handled_ == 0 ? Wish::kIdle : Wish::kStarved;  // idle before its first slot
    return is_empty(sequence_[handled_]) || !entry_is_valid(sequence_[handled_]) ? Wish::kPass
                                                                                 : Wish::kAccess;
  }

  bool can_be_consumed(Cycle now) const {
    return handled_ > consumed_ && now >= in_lane_.front().handled_at + setting_.image_latency;
  }

  // Updates at the end of cycle `now`.
  void lut_port_took(Cycle now) {
    in_lane_.push_back({now, now});
    ++taken_;
  }
  void pixel_port_handled(Cycle now) {
    if (!setting_.has_table) lut_port_took(now);  // the pixel port takes the slots itself
    in_lane_[handled_ - consumed_].handled_at = now;
    ++handled_;
  }
  void matcher_consumed() {
    in_lane_.pop_front();
    ++consumed_;
  }

 private:
  struct SlotInLane {
    Cycle taken_at;
    Cycle handled_at;  // meaningful once the slot is handled
  };

  // The wish of the port that takes slots: the LUT port, or the pixel port of a side without table.
  Wish wish_of_taker() const {
    if (taken_ == sequence_.size()) return Wish::kIdle;  // after its last slot
    if (in_lane_.size() >= lane_fifo_slots_) return Wish::kBlocked;
    return is_empty(sequence_[taken_]) ? Wish::kPass : Wish::kAccess;
  }

  bool is_empty(const Slot& slot) const { return slot.row < 0 || slot.row > height_ - 1; }

  bool entry_is_valid(const Slot& slot) const {
    if (setting_.entries == nullptr) return true;
    const auto place = static_cast<std::size_t>(slot.row) * static_cast<std::size_t>(width_) +
                       static_cast<std::size_t>(slot.column);
    return ((*setting_.entries)[place] >> 31U) == 1;
  }

  int width_;
  int height_;
  std::size_t lane_fifo_slots_;
  const std::vector<Slot>& sequence_;
  Setting setting_;
  std::deque<SlotInLane> in_lane_;  // taken and not yet consumed; the first is slot number consumed_
  std::size_t taken_ = 0;           // slots of the sequence, from the first
  std::size_t handled_ = 0;
  std::size_t consumed_ = 0;
};

// Counts consume-cycles into columns and columns into result words, during one frame.
class Matcher {
 public:
  Matcher(const PlainCycleInput& input, std::size_t slots) : slots_(static_cast<std::int64_t>(slots)) {
    const std::int64_t width = input.width;
    const std::int64_t r = (input.window - 1) / 2;
    const std::int64_t h = input.filter_half;
    const std::int64_t w = std::max<std::int64_t>(0, h - r);
    const std::int64_t drain_columns = input.disparities - 1 + r + h;  // C_d
    if (input.fetch == PlainFetch::kColumn) {
      cycles_per_column_ = input.window;
      columns_ahead_ = drain_columns + w * width;
    } else {
      cycles_per_column_ = 1;
      columns_ahead_ = drain_columns + (r + h) * width;
    }
    pixels_ = width * input.height;
    drain_cycles_ = drain_columns * cycles_per_column_;
  }

  bool needs_slots() const { return slots_consumed_ < slots_; }
  bool drains() const { return !needs_slots() && drain_cycles_done_ < drain_cycles_; }

  // One consume-cycle, with a slot of both lanes or in the drain. True if it completes a result word.
  bool consume() {
    ++(needs_slots() ? slots_consumed_ : drain_cycles_done_);
    ++cycles_of_column_;
    if (cycles_of_column_ < cycles_per_column_) return false;
    cycles_of_column_ = 0;
    const std::int64_t column = columns_consumed_++;
    const std::int64_t pixel = column - columns_ahead_;  // i, as column = i + C
    return pixel >= 0 && pixel < pixels_ && pixel % 4 == 3;
  }

 private:
  std::int64_t slots_;
  std::int64_t cycles_per_column_ = 0;  // K
  std::int64_t columns_ahead_ = 0;      // C
  std::int64_t pixels_ = 0;
  std::int64_t drain_cycles_ = 0;
  std::int64_t slots_consumed_ = 0;
  std::int64_t drain_cycles_done_ = 0;
  std::int64_t cycles_of_column_ = 0;
  std::int64_t columns_consumed_ = 0;
};

class ResultQueue {
 public:
  explicit ResultQueue(const PlainCycleInput& input)
      : capacity_(input.result_fifo_words), words_of_frame_(input.width * input.height / 4) {}

  bool has_free_place() const { return entered_ - written_ < capacity_; }
  bool all_written() const { return written_ == words_of_frame_; }
  Wish result_port_wish() const {
    if (entered_ > written_) return Wish::kAccess;
    return entered_ == 0 || all_written() ? Wish::kIdle : Wish::kStarved;
  }
  void word_enters() { ++entered_; }
  void word_is_written() { ++written_; }
  std::int64_t written() const { return written_; }

 private:
  std::int64_t capacity_;
  std::int64_t words_of_frame_;
  std::int64_t entered_ = 0;
  std::int64_t written_ = 0;
};

class CycleLoop {
 public:
  explicit CycleLoop(const PlainCycleInput& input) : input_(input), sequence_(slots_of_a_frame(input)) {
    for (const PlainBank& bank : input.banks) banks_.emplace_back(bank, input);
    result_.banks.resize(input.banks.size());
    blame_.resize(input.banks.size());
  }

  // Runs frame `frame`, whose cycle 0 is the absolute cycle `start`. Returns the absolute cycle of the last
  // granted result write, or nullopt if it was not granted in time.
  std::optional<Cycle> run_frame(int frame, Cycle start, std::uint64_t max_frame_cycles) {
    const auto entry = static_cast<std::size_t>(frame);
    const int left_image = input_.left_image[entry % input_.left_image.size()];
    const int right_image = input_.right_image[entry % input_.right_image.size()];
    const int disparity = input_.disparity[entry % input_.disparity.size()];
    Lane left(input_, sequence_, lane_setting(input_.left_lut, input_.left_table, left_image));
    Lane right(input_, sequence_, lane_setting(input_.right_lut, input_.right_table, right_image));
    Matcher matcher(input_, sequence_.size());
    ResultQueue queue(input_);

    bank_of_port_.fill(std::nullopt);
    bank_of_port_[index_of(PlainPort::kLeftLut)] = input_.left_lut;
    bank_of_port_[index_of(PlainPort::kRightLut)] = input_.right_lut;
    bank_of_port_[index_of(PlainPort::kLeftPixel)] = left_image;
    bank_of_port_[index_of(PlainPort::kRightPixel)] = right_image;
    bank_of_port_[index_of(PlainPort::kResult)] = disparity;

    std::vector<PlainRowEnd> rows;
    PlainRowEnd until_now;
    const Cycle end = start + static_cast<Cycle>(max_frame_cycles);
    for (Cycle now = start; now < end; ++now) {
      std::array<Wish, kPlainPortCount> wishes{};
      wishes[index_of(PlainPort::kLeftLut)] = left.lut_port_wish();
      wishes[index_of(PlainPort::kRightLut)] = right.lut_port_wish();
      wishes[index_of(PlainPort::kLeftPixel)] = left.pixel_port_wish(now);
      wishes[index_of(PlainPort::kRightPixel)] = right.pixel_port_wish(now);
      wishes[index_of(PlainPort::kResult)] = queue.result_port_wish();
      wishes[index_of(PlainPort::kHost)] = Wish::kIdle;

      const bool slots_ready = left.can_be_consumed(now) && right.can_be_consumed(now);
      const bool consumes =
          queue.has_free_place() && ((matcher.needs_slots() && slots_ready) || matcher.drains());
      const bool consumes_slots = consumes && matcher.needs_slots();

      const std::array<bool, kPlainPortCount> granted = arbitrate(wishes, now);
      count_port_states(wishes, granted);
      ++result_.counted_cycles;
      ++until_now.cycles;
      for (std::size_t port = 0; port < kPlainPortCount; ++port) {
        if (wishes[port] == Wish::kAccess && !granted[port]) ++until_now.stalls[port];
      }

      const auto acts = [&](PlainPort port) {
        return wishes[index_of(port)] == Wish::kPass || granted[index_of(port)];
      };
      if (consumes && matcher.consume()) queue.word_enters();
      if (consumes_slots) {
        left.matcher_consumed();
        right.matcher_consumed();
      }
      if (acts(PlainPort::kLeftPixel)) left.pixel_port_handled(now);
      if (acts(PlainPort::kRightPixel)) right.pixel_port_handled(now);
      if (acts(PlainPort::kLeftLut)) left.lut_port_took(now);
      if (acts(PlainPort::kRightLut)) right.lut_port_took(now);
      if (acts(PlainPort::kResult)) {
        queue.word_is_written();
        if (queue.written() * 4 % input_.width == 0) rows.push_back(until_now);
      }
      if (queue.all_written()) {
        result_.rows.push_back(rows);
        return now;
      }
    }
    return std::nullopt;
  }

  PlainCycleResult& result() { return result_; }

  void collect_blame() {
    for (std::size_t bank = 0; bank < blame_.size(); ++bank) {
      for (std::size_t victim = 0; victim < kPlainPortCount; ++victim) {
        for (std::size_t by = 0; by <= kTurnaround; ++by) {
          const std::uint64_t cycles = blame_[bank][victim][by];
          if (cycles == 0) continue;
          PlainBlame key{static_cast<PlainPort>(victim), static_cast<int>(bank), std::nullopt};
          if (by != kTurnaround) key.by = static_cast<PlainPort>(by);
          result_.blame[key] = cycles;
        }
      }
    }
  }

 private:
  static constexpr std::size_t kTurnaround = kPlainPortCount;
  using BlameOfBank = std::array<std::array<std::uint64_t, kPlainPortCount + 1>, kPlainPortCount>;

  Lane::Setting lane_setting(const std::optional<int>& lut,
                             const std::optional<std::vector<std::uint32_t>>& entries, int image) const {
    Lane::Setting setting;
    setting.has_table = lut.has_value();
    setting.entries = entries ? &*entries : nullptr;
    if (lut) setting.table_latency = read_latency(input_.banks[static_cast<std::size_t>(*lut)].kind);
    setting.image_latency = read_latency(input_.banks[static_cast<std::size_t>(image)].kind);
    return setting;
  }

  // Decides every bank, counts bank states and blame, and notes the grants in the banks.
  std::array<bool, kPlainPortCount> arbitrate(const std::array<Wish, kPlainPortCount>& wishes, Cycle now) {
    std::array<bool, kPlainPortCount> granted{};
    for (std::size_t bank = 0; bank < banks_.size(); ++bank) {
      PlainBankStates& states = result_.banks[bank];
      std::array<bool, kPlainPortCount> requests{};
      int request_count = 0;
      for (std::size_t port = 0; port < kPlainPortCount; ++port) {
        requests[port] = wishes[port] == Wish::kAccess && bank_of_port_[port] == static_cast<int>(bank);
        if (requests[port]) ++request_count;
      }
      if (request_count == 0) {
        ++states.idle;
        continue;
      }
      if (request_count >= 2) ++states.contended;

      const PlainPort winner = *banks_[bank].winner(requests);
      const Direction direction = winner == PlainPort::kResult ? Direction::kWrite : Direction::kRead;
      const bool refused = banks_[bank].is_turning_round(direction, now);
      if (refused) {
        ++states.turnaround;
      } else {
        ++states.busy;
        ++(direction == Direction::kRead ? states.reads : states.writes);
        banks_[bank].grant(winner, direction, now);
        granted[index_of(winner)] = true;
      }
      for (std::size_t port = 0; port < kPlainPortCount; ++port) {
        if (requests[port] && !granted[port]) ++blame_[bank][port][refused ? kTurnaround : index_of(winner)];
      }
    }
    return granted;
  }

  void count_port_states(const std::array<Wish, kPlainPortCount>& wishes,
                         const std::array<bool, kPlainPortCount>& granted) {
    for (std::size_t port = 0; port < kPlainPortCount; ++port) {
      PlainPortStates& states = result_.ports[port];
      switch (wishes[port]) {
        case Wish::kIdle:
          ++states.idle;
          break;
        case Wish::kBlocked:
          ++states.blocked;
          break;
        case Wish::kStarved:
          ++states.starved;
          break;
        case Wish::kPass:
          ++states.passed;
          break;
        case Wish::kAccess:
          ++(granted[port] ? states.granted : states.stalled);
          break;
      }
    }
  }

  const PlainCycleInput& input_;
  std::vector<Slot> sequence_;
  std::vector<BankAndArbiter> banks_;
  std::array<std::optional<int>, kPlainPortCount> bank_of_port_;
  std::vector<BlameOfBank> blame_;
  PlainCycleResult result_;
};

}  // namespace

PlainCycleResult run_plain_cycle_loop(const PlainCycleInput& input, int frames,
                                      std::uint64_t max_frame_cycles) {
  require_sound(input);
  if (frames < 1) {
    throw std::invalid_argument("plain cycle loop: frames = " + std::to_string(frames) + ": at least 1");
  }
  CycleLoop loop(input);
  Cycle start = 0;
  for (int frame = 0; frame < frames; ++frame) {
    const std::optional<Cycle> last_write = loop.run_frame(frame, start, max_frame_cycles);
    if (!last_write) {
      loop.result().hang = true;
      break;
    }
    const Cycle frame_cycles = *last_write - start + 1 + input.pipeline_latency_cycles;
    loop.result().frame_cycles.push_back(static_cast<std::uint64_t>(frame_cycles));
    start += frame_cycles;
  }
  loop.collect_blame();
  return loop.result();
}

std::size_t plain_slot_count(const PlainCycleInput& input) {
  require_sound(input);
  return slots_of_a_frame(input).size();
}

}  // namespace stereotlm::test
