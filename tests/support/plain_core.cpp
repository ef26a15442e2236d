#include "tests/support/plain_core.h"

#include <algorithm>
#include <deque>

namespace stereotlm::test {
namespace {

// Absolute cycles, counted from the first cycle of frame 0.
using Cycle = std::int64_t;

enum class Direction { kRead, kWrite };

// The wish of a port follows from the state at the beginning of a cycle. kAccess becomes granted or stalled,
// each other wish is the port's state in that cycle.
enum class Wish { kIdle, kBlocked, kStarved, kPass, kAccess };

std::size_t index_of(PlainPort port) { return static_cast<std::size_t>(port); }

int read_latency(PlainBankKind kind) { return kind == PlainBankKind::kZbtFlowThrough ? 1 : 2; }

// One port of a bank and its arbiter; both keep their state from frame to frame.
class BankAndArbiter {
 public:
  BankAndArbiter(const PlainBank& bank, const PlainCycleInput& input)
      : bank_(bank), arbitration_(input.arbitration), priority_(input.priority) {}

  // The winner among the ports that request this bank; nullopt if none does.
  std::optional<PlainPort> winner(const std::array<bool, kPlainPortCount>& requests, Cycle now) const {
    if (arbitration_ == PlainArbitration::kAge) return oldest(requests, now);
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

  // Whether an earlier access in the other direction still forbids one in this direction.
  bool is_turning_round(Direction direction, Cycle now) const {
    if (bank_.kind != PlainBankKind::kSyncBurst) return false;
    const std::optional<Cycle>& other = direction == Direction::kRead ? last_write_ : last_read_;
    return other && now < *other + bank_.turnaround_cycles + 1;
  }

  void grant(PlainPort port, Direction direction, Cycle now) {
    last_granted_ = port;
    (direction == Direction::kRead ? last_read_ : last_write_) = now;
  }

  // The port has asked in this cycle, and is not granted.
  void refuse(PlainPort port, Cycle now) {
    Wait& wait = waits_[index_of(port)];
    wait.cycles = age(port, now);
    wait.last = now;
  }

 private:
  struct Wait {
    Cycle cycles = 0;           // number of consecutive cycles with a request and without a grant
    std::optional<Cycle> last;  // the last of these cycles
  };

  // The age of a request in this cycle.
  Cycle age(PlainPort port, Cycle now) const {
    const Wait& wait = waits_[index_of(port)];
    return wait.last == now - 1 ? wait.cycles + 1 : 1;
  }
  std::optional<PlainPort> oldest(const std::array<bool, kPlainPortCount>& requests, Cycle now) const {
    std::optional<PlainPort> found;
    for (const PlainPort port : priority_) {
      if (requests[index_of(port)] && (!found || age(port, now) > age(*found, now))) found = port;
    }
    return found;
  }

  PlainBank bank_;
  PlainArbitration arbitration_;
  std::array<PlainPort, kPlainPortCount> priority_;
  std::optional<PlainPort> last_granted_;
  std::optional<Cycle> last_read_;
  std::optional<Cycle> last_write_;
  std::array<Wait, kPlainPortCount> waits_{};  // of each port, the last
};

// The figures of a frame that contract sections 2 and 7 name by these letters.
struct Letters {
  explicit Letters(const PlainCycleInput& input)
      : R(input.rows),
        r((input.window - 1) / 2),
        h(input.filter_half + input.cost_half),
        w(R * up(std::max(0, h - r), R)),
        K(input.fetch == PlainFetch::kColumn ? input.window + R - 1 : 1),
        S(input.units == 0 ? 1 : up(input.disparities, input.units)) {}

  int R;
  int r;
  int h;
  int w;
  int K;
  int S;

  // ceil(dividend / divisor)
  static int up(int dividend, int divisor) { return (dividend + divisor - 1) / divisor; }
};

// The rectified pixel that a slot is for; the row may be outside the image.
struct Slot {
  int column = 0;
  int row = 0;
  int k = 0;            // its place in its column; line_buffer: 0
  bool begins = false;  // is the first slot of a strip; line_buffer: of a row
};

std::vector<Slot> slots_of_a_frame(const PlainCycleInput& input) {
  const Letters is(input);
  std::vector<Slot> slots;
  if (input.fetch == PlainFetch::kColumn) {
    for (int v = -is.w; v < input.height; v += is.R) {
      for (int u = 0; u <= input.width - 1; ++u) {
        for (int k = 0; k <= is.K - 1; ++k) slots.push_back({u, v + is.h - is.r + k, k, u == 0 && k == 0});
      }
    }
  } else {
    for (int y = 0; y <= input.height + is.r + is.h - 1; ++y) {
      for (int u = 0; u <= input.width - 1; ++u) slots.push_back({u, y, 0, u == 0});
    }
  }
  return slots;
}

// One side of the core during one frame.
class Lane {
 public:
  struct Setting {
    bool has_table = false;
    const std::vector<std::uint32_t>* entries = nullptr;  // of the table; null: the identity
    int table_latency = 0;                                // read latency of the table's bank
    int image_latency = 0;                                // read latency of the bank of this frame's image
  };

  Lane(const PlainCycleInput& input, const std::vector<Slot>& sequence, const Setting& setting)
      : width_(input.width),
        height_(input.height),
        lane_fifo_slots_(static_cast<std::size_t>(input.lane_fifo_slots)),
        has_cache_(input.word_cache),
        sequence_(sequence),
        setting_(setting),
        kept_(static_cast<std::size_t>(Letters(input).K)) {}

  Wish lut_port_wish() const { return setting_.has_table ? wish_of_taker() : Wish::kIdle; }

  Wish pixel_port_wish(Cycle now) const {
    if (!setting_.has_table) return wish_of_taker();
    if (handled_ == sequence_.size()) return Wish::kIdle;  // after its last slot
    const bool can_handle =
        handled_ < taken_ && now >= in_lane_[handled_ - consumed_].taken_at + setting_.table_latency;
    if (!can_handle) return handled_ == 0 ? Wish::kIdle : Wish::kStarved;  // idle before its first slot
    return needs_access(sequence_[handled_]) ? Wish::kAccess : Wish::kPass;
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
    keep_word_of(sequence_[handled_]);
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
    const Slot& slot = sequence_[taken_];
    if (setting_.has_table) return is_empty(slot) ? Wish::kPass : Wish::kAccess;
    return needs_access(slot) ? Wish::kAccess : Wish::kPass;
  }

  bool is_empty(const Slot& slot) const { return slot.row < 0 || slot.row > height_ - 1; }

  // Of the pixel port.
  bool needs_access(const Slot& slot) const {
    if (is_empty(slot) || !word_of(slot)) return false;
    return !has_cache_ || slot.begins || kept_[static_cast<std::size_t>(slot.k)] != word_of(slot);
  }

  // The word of the picture in which the source pixel of a slot that is not empty lies; nullopt if the entry
  // is not valid.
  std::optional<int> word_of(const Slot& slot) const {
    const int place = slot.row * width_ + slot.column;
    if (setting_.entries == nullptr) return place / 4;
    const std::uint32_t entry = (*setting_.entries)[static_cast<std::size_t>(place)];
    if (entry >> 31U == 0) return std::nullopt;
    const int source_row = static_cast<int>(entry >> 16U & 0x7FFU);
    const int source_column = static_cast<int>(entry & 0x7FFU);
    return (source_row * width_ + source_column) / 4;
  }

  void keep_word_of(const Slot& slot) {
    if (slot.begins) std::fill(kept_.begin(), kept_.end(), std::nullopt);
    if (!is_empty(slot) && word_of(slot)) kept_[static_cast<std::size_t>(slot.k)] = word_of(slot);
  }

  int width_;
  int height_;
  std::size_t lane_fifo_slots_;
  bool has_cache_;
  const std::vector<Slot>& sequence_;
  Setting setting_;
  std::vector<std::optional<int>> kept_;  // [k]: the last word that was read in the strip
  std::deque<SlotInLane> in_lane_;        // taken and not yet consumed; the first is slot number consumed_
  std::size_t taken_ = 0;                 // slots of the sequence, from the first
  std::size_t handled_ = 0;
  std::size_t consumed_ = 0;
};

// Counts consume-cycles into columns and columns into result words, during one frame.
class Matcher {
 public:
  Matcher(const PlainCycleInput& input, std::size_t slots)
      : is_(input), width_(input.width), height_(input.height), slots_(static_cast<std::int64_t>(slots)) {
    const std::int64_t drain_columns = input.disparities - 1 + is_.r + is_.h;  // C_d
    const std::int64_t strips_ahead = input.fetch == PlainFetch::kColumn ? is_.w / is_.R : is_.r + is_.h;
    columns_ahead_ = drain_columns + strips_ahead * width_;
    drain_cycles_ = drain_columns * is_.K;
  }

  bool needs_slots() const { return slots_consumed_ < slots_; }
  bool drains() const { return !needs_slots() && drain_cycles_done_ < drain_cycles_; }

  // It works on one slot of both lanes, or on a consume-cycle of the drain, for S cycles from `now` on.
  bool works() const { return began_.has_value(); }
  void begin(Cycle now) { began_ = now; }
  bool ends(Cycle now) const { return began_ && now == *began_ + is_.S - 1; }

  // Whether column C - 1 has been consumed.
  bool has_filled() const { return columns_consumed_ >= columns_ahead_; }
  // The end of a consume-cycle. Returns the rows in which it completes a result word, in their order.
  std::vector<int> consume() {
    began_.reset();
    ++(needs_slots() ? slots_consumed_ : drain_cycles_done_);
    ++cycles_of_column_;
    if (cycles_of_column_ < is_.K) return {};
    cycles_of_column_ = 0;
    const std::int64_t column = columns_consumed_++;
    const std::int64_t i = column - columns_ahead_;  // as column = i + C
    if (i < 0 || i % 4 != 3) return {};
    std::vector<int> rows;
    for (int strip_row = 0; strip_row < is_.R; ++strip_row) {
      const std::int64_t row = is_.R * (i / width_) + strip_row;
      if (row < height_) rows.push_back(static_cast<int>(row));
    }
    return rows;
  }

 private:
  Letters is_;
  std::int64_t width_;
  std::int64_t height_;
  std::int64_t slots_;
  std::int64_t columns_ahead_ = 0;  // C
  std::int64_t drain_cycles_ = 0;
  std::optional<Cycle> began_;
  std::int64_t slots_consumed_ = 0;
  std::int64_t drain_cycles_done_ = 0;
  std::int64_t cycles_of_column_ = 0;
  std::int64_t columns_consumed_ = 0;
};

class ResultQueue {
 public:
  explicit ResultQueue(const PlainCycleInput& input)
      : capacity_(input.result_fifo_words),
        words_of_frame_(input.width * input.height / 4),
        words_of_row_(input.width / 4),
        written_in_row_(static_cast<std::size_t>(input.height)) {}

  bool has_free_places(int places) const {
    return static_cast<std::int64_t>(rows_of_words_.size()) + places <= capacity_;
  }
  bool all_written() const { return written_ == words_of_frame_; }
  Wish result_port_wish() const {
    if (!rows_of_words_.empty()) return Wish::kAccess;
    return written_ == 0 || all_written() ? Wish::kIdle : Wish::kStarved;
  }
  void word_enters(int row) { rows_of_words_.push_back(row); }
  // Returns its row if that is complete.
  std::optional<std::size_t> word_is_written() {
    const auto row = static_cast<std::size_t>(rows_of_words_.front());
    rows_of_words_.pop_front();
    ++written_;
    if (++written_in_row_[row] < words_of_row_) return std::nullopt;
    return row;
  }

 private:
  std::int64_t capacity_;
  std::int64_t words_of_frame_;
  std::int64_t words_of_row_;
  std::deque<int> rows_of_words_;  // row of each word in the queue
  std::int64_t written_ = 0;
  std::vector<std::int64_t> written_in_row_;
};

}  // namespace

class PlainCore::Cycles {
 public:
  explicit Cycles(const PlainCycleInput& input) : input_(input), sequence_(slots_of_a_frame(input)) {
    for (const PlainBank& bank : input.banks) banks_.push_back(ports_of(bank));
    result_.banks.resize(input.banks.size());
    blame_.resize(input.banks.size());
    const int strips = (input.height + input.rows - 1) / input.rows;
    groups_ = static_cast<std::size_t>(input.width / 4);
    result_.tiles.resize(1 + static_cast<std::size_t>(strips) * groups_);
  }

  void start_frame(int frame) {
    const auto entry = static_cast<std::size_t>(frame);
    const int left_image = input_.left_image[entry % input_.left_image.size()];
    const int right_image = input_.right_image[entry % input_.right_image.size()];
    bank_of_port_.fill(std::nullopt);
    bank_of_port_[index_of(PlainPort::kLeftLut)] = input_.left_lut;
    if (!input_.joint_tables) bank_of_port_[index_of(PlainPort::kRightLut)] = input_.right_lut;
    bank_of_port_[index_of(PlainPort::kLeftPixel)] = left_image;
    bank_of_port_[index_of(PlainPort::kRightPixel)] = right_image;
    bank_of_port_[index_of(PlainPort::kResult)] = input_.disparity[entry % input_.disparity.size()];
    frame_.emplace(
        Frame{Lane(input_, sequence_, lane_setting(input_.left_lut, input_.left_table, left_image)),
              Lane(input_, sequence_, lane_setting(input_.right_lut, input_.right_table, right_image)),
              Matcher(input_, sequence_.size()),
              ResultQueue(input_),
              std::vector<PlainRowEnd>(static_cast<std::size_t>(input_.height)),
              {},
              0,
              std::vector<PlainStrip>(1 + (result_.tiles.size() - 1) / groups_)});
    for (PlainStrip& strip : frame_->strips) strip.accesses.resize(banks_.size());
  }

  bool runs() const { return frame_.has_value(); }

  bool step(Cycle now, const std::optional<PlainHostRequest>& host) {
    std::array<Wish, kPlainPortCount> wishes{};  // idle
    if (frame_) {
      wishes[index_of(PlainPort::kLeftLut)] = frame_->left.lut_port_wish();
      if (!input_.joint_tables) wishes[index_of(PlainPort::kRightLut)] = frame_->right.lut_port_wish();
      wishes[index_of(PlainPort::kLeftPixel)] = frame_->left.pixel_port_wish(now);
      wishes[index_of(PlainPort::kRightPixel)] = frame_->right.pixel_port_wish(now);
      wishes[index_of(PlainPort::kResult)] = frame_->queue.result_port_wish();
    }
    if (host) wishes[index_of(PlainPort::kHost)] = Wish::kAccess;
    bank_of_port_[index_of(PlainPort::kHost)] = host ? std::optional<int>(host->bank) : std::nullopt;
    host_direction_ = host && host->write ? Direction::kWrite : Direction::kRead;
    if (host) traffic_ = host->traffic;

    const std::array<bool, kPlainPortCount> granted = arbitrate(wishes, now);
    if (frame_) step_frame(wishes, granted, now);
    return granted[index_of(PlainPort::kHost)];
  }

  PlainCycleResult result() const {
    PlainCycleResult result = result_;
    collect_blame(result);
    return result;
  }

 private:
  static constexpr std::size_t kTurnaround = kPlainPortCount;
  using BlameOfBank = std::array<std::array<std::uint64_t, kPlainPortCount + 1>, kPlainPortCount>;
  struct Frame {
    Lane left;
    Lane right;
    Matcher matcher;
    ResultQueue queue;
    std::vector<PlainRowEnd> rows;
    PlainRowEnd until_now;
    std::size_t tile;  // of the next results
    std::vector<PlainStrip> strips;
  };

  std::size_t strip_of(std::size_t tile) const { return tile == 0 ? 0 : 1 + (tile - 1) / groups_; }
  std::size_t waiter_of(std::size_t port) const {
    return port < index_of(PlainPort::kHost) ? port : port + static_cast<std::size_t>(traffic_);
  }
  void note_loss(std::size_t port, std::size_t bank, const std::optional<PlainPort>& by) {
    const std::size_t to_blame = by ? waiter_of(index_of(*by)) : kPlainWaiters;
    ++result_.tiles[frame_->tile].lost[{waiter_of(port), static_cast<int>(bank), to_blame}];
    ++frame_->strips[strip_of(frame_->tile)].lost[waiter_of(port)];
  }
  void note_access(PlainPort port, std::size_t bank) {
    const std::size_t kind = port == PlainPort::kHost ? 1 + static_cast<std::size_t>(traffic_) : 0;
    ++frame_->strips[strip_of(frame_->tile)].accesses[bank][kind];
  }

  void step_frame(const std::array<Wish, kPlainPortCount>& wishes,
                  const std::array<bool, kPlainPortCount>& granted, Cycle now) {
    Frame& frame = *frame_;
    const bool slots_ready = frame.left.can_be_consumed(now) && frame.right.can_be_consumed(now);
    const bool begins = !frame.matcher.works() && frame.queue.has_free_places(input_.rows) &&
                        ((frame.matcher.needs_slots() && slots_ready) || frame.matcher.drains());
    if (begins) frame.matcher.begin(now);
    const bool consumes = frame.matcher.ends(now);
    const bool consumes_slots = consumes && frame.matcher.needs_slots();

    count_port_states(wishes, granted);
    ++result_.counted_cycles;
    ++frame.until_now.cycles;
    ++frame.strips[strip_of(frame.tile)].cycles;
    ++result_.tiles[frame.tile].cycles;
    for (std::size_t port = 0; port < kPlainPortCount; ++port) {
      if (wishes[port] == Wish::kAccess && !granted[port]) ++frame.until_now.stalls[port];
    }

    const auto acts = [&](PlainPort port) {
      return wishes[index_of(port)] == Wish::kPass || granted[index_of(port)];
    };
    if (acts(PlainPort::kResult)) {
      if (const auto row = frame.queue.word_is_written()) frame.rows[*row] = frame.until_now;
    }
    if (consumes) {
      const std::vector<int> rows = frame.matcher.consume();
      for (const int row : rows) frame.queue.word_enters(row);
      if (frame.tile == 0 ? frame.matcher.has_filled() : !rows.empty())
        frame.tile = std::min(frame.tile + 1, result_.tiles.size() - 1);
    }
    if (consumes_slots) {
      frame.left.matcher_consumed();
      frame.right.matcher_consumed();
    }
    if (acts(PlainPort::kLeftPixel)) frame.left.pixel_port_handled(now);
    if (acts(PlainPort::kRightPixel)) frame.right.pixel_port_handled(now);
    if (acts(PlainPort::kLeftLut)) frame.left.lut_port_took(now);
    if (input_.joint_tables ? acts(PlainPort::kLeftLut) : acts(PlainPort::kRightLut))
      frame.right.lut_port_took(now);
    if (!frame.queue.all_written()) return;
    result_.rows.push_back(frame.rows);
    result_.strips.push_back(frame.strips);
    frame_.reset();
  }

  Lane::Setting lane_setting(const std::optional<int>& lut,
                             const std::optional<std::vector<std::uint32_t>>& entries, int image) const {
    Lane::Setting setting;
    setting.has_table = lut.has_value();
    setting.entries = entries ? &*entries : nullptr;
    if (lut) setting.table_latency = read_latency(input_.banks[static_cast<std::size_t>(*lut)].kind);
    setting.image_latency = read_latency(input_.banks[static_cast<std::size_t>(image)].kind);
    return setting;
  }

  Direction direction_of(PlainPort port) const {
    if (port == PlainPort::kHost) return host_direction_;
    return port == PlainPort::kResult ? Direction::kWrite : Direction::kRead;
  }

  // A port of a bank, and the directions of the accesses that it serves.
  struct BankPort {
    BankAndArbiter arbiter;
    std::vector<Direction> directions;
  };

  std::vector<BankPort> ports_of(const PlainBank& bank) const {
    const BankAndArbiter arbiter(bank, input_);
    if (bank.kind != PlainBankKind::kQdr) return {{arbiter, {Direction::kRead, Direction::kWrite}}};
    return {{arbiter, {Direction::kRead}}, {arbiter, {Direction::kWrite}}};
  }

  // Decides every bank, and notes the grants in the banks. Within a frame it counts bank states and blame.
  std::array<bool, kPlainPortCount> arbitrate(const std::array<Wish, kPlainPortCount>& wishes, Cycle now) {
    std::array<bool, kPlainPortCount> granted{};
    PlainBankStates not_counted;
    BlameOfBank blame_not_counted{};
    for (std::size_t bank = 0; bank < banks_.size(); ++bank) {
      PlainBankStates& states = frame_ ? result_.banks[bank] : not_counted;
      BlameOfBank& blame = frame_ ? blame_[bank] : blame_not_counted;
      bool is_busy = false;
      bool is_turning = false;
      bool is_contended = false;
      for (BankPort& bank_port : banks_[bank]) {
        std::array<bool, kPlainPortCount> requests{};
        int request_count = 0;
        for (std::size_t port = 0; port < kPlainPortCount; ++port) {
          const std::vector<Direction>& served = bank_port.directions;
          requests[port] =
              wishes[port] == Wish::kAccess && bank_of_port_[port] == static_cast<int>(bank) &&
              std::count(served.begin(), served.end(), direction_of(static_cast<PlainPort>(port)));
          if (requests[port]) ++request_count;
        }
        if (request_count == 0) continue;
        if (request_count >= 2) is_contended = true;

        const PlainPort winner = *bank_port.arbiter.winner(requests, now);
        const Direction direction = direction_of(winner);
        const bool refused = bank_port.arbiter.is_turning_round(direction, now);
        if (refused) {
          is_turning = true;
        } else {
          is_busy = true;
          ++(direction == Direction::kRead ? states.reads : states.writes);
          bank_port.arbiter.grant(winner, direction, now);
          granted[index_of(winner)] = true;
          if (frame_) note_access(winner, bank);
        }
        for (std::size_t port = 0; port < kPlainPortCount; ++port) {
          if (!requests[port] || granted[port]) continue;
          ++blame[port][refused ? kTurnaround : index_of(winner)];
          if (frame_) note_loss(port, bank, refused ? std::nullopt : std::optional(winner));
          bank_port.arbiter.refuse(static_cast<PlainPort>(port), now);
        }
      }
      if (is_contended) ++states.contended;
      ++(is_busy ? states.busy : is_turning ? states.turnaround : states.idle);
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

  void collect_blame(PlainCycleResult& result) const {
    for (std::size_t bank = 0; bank < blame_.size(); ++bank) {
      for (std::size_t victim = 0; victim < kPlainPortCount; ++victim) {
        for (std::size_t by = 0; by <= kTurnaround; ++by) {
          const std::uint64_t cycles = blame_[bank][victim][by];
          if (cycles == 0) continue;
          PlainBlame key{static_cast<PlainPort>(victim), static_cast<int>(bank), std::nullopt};
          if (by != kTurnaround) key.by = static_cast<PlainPort>(by);
          result.blame[key] = cycles;
        }
      }
    }
  }

  const PlainCycleInput& input_;
  std::vector<Slot> sequence_;
  std::vector<std::vector<BankPort>> banks_;
  std::array<std::optional<int>, kPlainPortCount> bank_of_port_;
  Direction host_direction_ = Direction::kRead;
  PlainTraffic traffic_ = PlainTraffic::kReadBack;
  std::size_t groups_ = 0;      // of four columns, in a strip
  std::optional<Frame> frame_;  // that runs, until its last result write
  std::vector<BlameOfBank> blame_;
  PlainCycleResult result_;
};

PlainCore::PlainCore(const PlainCycleInput& input) : cycles_(std::make_unique<Cycles>(input)) {}
PlainCore::~PlainCore() = default;
void PlainCore::start_frame(int frame) { cycles_->start_frame(frame); }
bool PlainCore::runs() const { return cycles_->runs(); }
bool PlainCore::step(std::int64_t now, const std::optional<PlainHostRequest>& host) {
  return cycles_->step(now, host);
}
PlainCycleResult PlainCore::result() const { return cycles_->result(); }

const char* name_of(PlainPort port) {
  static constexpr std::array<const char*, kPlainPortCount> kNames = {
      "left_lut", "right_lut", "left_pixel", "right_pixel", "result", "host"};
  return kNames[index_of(port)];
}

const char* name_of(PlainArbitration arbitration) {
  static constexpr std::array<const char*, 3> kNames = {"fixed_priority", "round_robin", "age"};
  return kNames[static_cast<std::size_t>(arbitration)];
}

int plain_read_latency(PlainBankKind kind) { return read_latency(kind); }

}  // namespace stereotlm::test
