#include "tests/support/plain_core.h"

#include <algorithm>
#include <deque>
#include <iterator>
#include <map>
#include <utility>

namespace stereotlm::test {
namespace {

// Absolute cycles, counted from the first cycle of frame 0.
using Cycle = std::int64_t;

enum class Direction { kRead, kWrite };

// The wish of a port follows from the state at the beginning of a cycle. kAccess becomes granted or stalled,
// each other wish is the port's state in that cycle.
enum class Wish { kIdle, kBlocked, kStarved, kPass, kAccess };

std::size_t index_of(PlainPort port) { return static_cast<std::size_t>(port); }

struct Request {
  Wish wish = Wish::kIdle;
  PlainWord at{};  // kAccess
  Direction direction = Direction::kRead;
};

std::size_t port_count(const PlainCycleInput& input) { return 4 * static_cast<std::size_t>(input.lanes) + 2; }

// The place of each port in the list: each group stands for its ports, lower p first.
std::vector<std::size_t> places_in_list(const PlainCycleInput& input) {
  const auto lanes = static_cast<std::size_t>(input.lanes);
  std::vector<std::size_t> places(port_count(input));
  std::size_t place = 0;
  for (const PlainPort group : input.priority) {
    if (group == PlainPort::kResult || group == PlainPort::kHost) {
      places[4 * lanes + (group == PlainPort::kHost ? 1 : 0)] = place++;
    } else {
      for (std::size_t p = 0; p < lanes; ++p) places[index_of(group) * lanes + p] = place++;
    }
  }
  return places;
}

// A bank, or a direction of a qdr bank, and its arbiter; both keep their state from frame to frame.
class BankAndArbiter {
 public:
  BankAndArbiter(const PlainBank& bank, const PlainCycleInput& input)
      : bank_(bank),
        arbitration_(input.arbitration),
        place_(places_in_list(input)),
        waits_(place_.size()),
        open_rows_(static_cast<std::size_t>(bank.sdram.internal_banks)) {}

  // Decides cycle `now`, greater than the last one, among the ports that request this bank. Returns the port
  // that is granted, else the cause for which none is; nullopt if there is neither.
  std::optional<std::size_t> decide(const std::vector<std::size_t>& ports,
                                    const std::vector<Request>& requests, Cycle now) {
    const std::optional<std::size_t> outcome = outcome_of(ports, requests, now);
    for (const std::size_t port : ports) {
      if (port != outcome) waits_[port] = {age(port, now), now};
    }
    return outcome;
  }

  // The refreshes before cycle `end` begin, if nobody requests in the cycles before it.
  void pass(Cycle end) {
    for (; next_ < end; ++next_) refresh_if_due(next_);
  }

  const PlainBankWork& work() const { return work_; }  // up to now, without accesses

 private:
  struct Wait {
    Cycle cycles = 0;           // number of consecutive cycles with a request and without a grant
    std::optional<Cycle> last;  // the last of these cycles
  };

  // The causes that are no port.
  std::size_t turnaround() const { return place_.size(); }
  std::size_t row() const { return place_.size() + 1; }
  std::size_t refresh() const { return place_.size() + 2; }

  // The rules in their order: refresh, winner, its row, its turnaround. Only sdram has refreshes and rows.
  std::optional<std::size_t> outcome_of(const std::vector<std::size_t>& ports,
                                        const std::vector<Request>& requests, Cycle now) {
    pass(now + 1);
    if (now < busy_until_) return busy_with_;
    if (ports.empty()) return std::nullopt;
    const std::size_t winner =
        *std::min_element(ports.begin(), ports.end(),
                          [&](std::size_t a, std::size_t b) { return rank(a, now) < rank(b, now); });
    const Request& request = requests[winner];
    open_row_of(request.at.word, now);
    if (now < busy_until_) return busy_with_;
    if (is_turning_round(request.direction, now)) return turnaround();
    last_granted_ = winner;
    (request.direction == Direction::kRead ? last_read_ : last_write_) = now;
    return winner;
  }

  // The least wins.
  std::pair<Cycle, std::size_t> rank(std::size_t port, Cycle now) const {
    const std::size_t count = place_.size();
    if (arbitration_ == PlainArbitration::kAge) return {-age(port, now), place_[port]};
    if (arbitration_ == PlainArbitration::kRoundRobin && last_granted_)
      return {0, (place_[port] + count - place_[*last_granted_] - 1) % count};
    return {0, place_[port]};
  }

  // The age of a request in this cycle.
  Cycle age(std::size_t port, Cycle now) const {
    const Wait& wait = waits_[port];
    return wait.last == now - 1 ? wait.cycles + 1 : 1;
  }

  // Whether an earlier access in the other direction still forbids one in this direction.
  bool is_turning_round(Direction direction, Cycle now) const {
    if (bank_.kind == PlainBankKind::kSdram) {
      return direction == Direction::kWrite && last_read_ && now - *last_read_ < bank_.sdram.cas_latency + 1;
    }
    if (bank_.kind != PlainBankKind::kSyncBurst) return false;
    const std::optional<Cycle>& other = direction == Direction::kRead ? last_write_ : last_read_;
    return other && now < *other + bank_.turnaround_cycles + 1;
  }

  void refresh_if_due(Cycle now) {
    const PlainSdram& sdram = bank_.sdram;
    if (bank_.kind != PlainBankKind::kSdram || sdram.refresh_interval_cycles == 0 || now < busy_until_)
      return;
    if (now < next_refresh_ * sdram.refresh_interval_cycles) return;
    ++next_refresh_;
    ++work_.refreshes;
    const bool any_open =
        std::any_of(open_rows_.begin(), open_rows_.end(), [](const auto& open) { return open.has_value(); });
    busy_until_ = now + sdram.refresh_cycles + (any_open ? sdram.precharge_cycles : 0);
    busy_with_ = refresh();
    std::fill(open_rows_.begin(), open_rows_.end(), std::nullopt);
  }

  void open_row_of(std::uint64_t word, Cycle now) {
    const PlainSdram& sdram = bank_.sdram;
    if (bank_.kind != PlainBankKind::kSdram) return;
    const std::uint64_t row_of_word = word / static_cast<std::uint64_t>(sdram.row_words);
    std::optional<std::uint64_t>& open = open_rows_[row_of_word % open_rows_.size()];
    if (open == row_of_word) return;
    ++work_.rows_opened;
    busy_until_ = now + sdram.activate_cycles + (open ? sdram.precharge_cycles : 0);
    busy_with_ = row();
    open = row_of_word;
  }

  PlainBank bank_;
  PlainArbitration arbitration_;
  std::vector<std::size_t> place_;  // [port]
  std::optional<std::size_t> last_granted_;
  std::optional<Cycle> last_read_;
  std::optional<Cycle> last_write_;
  std::vector<Wait> waits_;  // of each port, the last
  Cycle next_ = 0;           // whose refresh is not yet looked at
  Cycle next_refresh_ = 1;   // m
  Cycle busy_until_ = 0;     // with a refresh or an opening
  std::size_t busy_with_ = 0;
  std::vector<std::optional<std::uint64_t>> open_rows_;  // [internal bank]
  PlainBankWork work_;
};

// The figures of a frame, by their letters in the contract; P and G are of section 8 (lanes).
struct Letters {
  explicit Letters(const PlainCycleInput& input)
      : R(input.rows),
        r((input.window - 1) / 2),
        h(input.filter_half + input.cost_half),
        w(R * up(std::max(0, h - r), R)),
        K(input.fetch == PlainFetch::kColumn ? input.window + R - 1 : 1),
        P(input.lanes),
        G(up(K, P)),
        S(input.units == 0 ? 1 : up(input.disparities, input.units)) {}

  int R;
  int r;
  int h;
  int w;
  int K;
  int P;
  int G;
  int S;

  // ceil(dividend / divisor)
  static int up(int dividend, int divisor) { return (dividend + divisor - 1) / divisor; }
};

// The rectified pixel that a slot is for; the row may be outside the image.
struct Slot {
  int column = 0;
  int row = 0;
  int k = 0;            // its place in its column; line_buffer: 0
  bool begins = false;  // the first one of its k in a strip; line_buffer: of a row
};

// The slots of lane p.
std::vector<Slot> slots_of_a_frame(const PlainCycleInput& input, int p) {
  const Letters is(input);
  std::vector<Slot> slots;
  if (input.fetch == PlainFetch::kColumn) {
    for (int v = -is.w; v < input.height; v += is.R) {
      for (int u = 0; u <= input.width - 1; ++u) {
        for (int k = 0; k <= is.K - 1; ++k) {
          if (k % is.P == p) slots.push_back({u, v + is.h - is.r + k, k, u == 0});
        }
      }
    }
  } else {
    for (int y = 0; y <= input.height + is.r + is.h - 1; ++y) {
      for (int u = 0; u <= input.width - 1; ++u) slots.push_back({u, y, 0, u == 0});
    }
  }
  return slots;
}

// One lane during one frame.
class Lane {
 public:
  struct Setting {
    const std::vector<std::uint32_t>* entries = nullptr;  // of the table; null: the identity
    PlainParts table;                                     // none: a side without table
    PlainParts image;                                     // of this frame
    int table_latency = 0;                                // read latency of the table's banks
    int image_latency = 0;                                // read latency of the image's banks
  };

  Lane(const PlainCycleInput& input, const std::vector<Slot>& sequence, const Setting& setting)
      : width_(input.width),
        height_(input.height),
        lane_fifo_slots_(static_cast<std::size_t>(input.lane_fifo_slots)),
        has_cache_(input.word_cache),
        sequence_(sequence),
        setting_(setting),
        kept_(static_cast<std::size_t>(Letters(input).K)) {}

  Request lut_port_request() const { return has_table() ? request_of_taker() : Request{}; }

  Request pixel_port_request(Cycle now) const {
    if (!has_table()) return request_of_taker();
    if (handled_ == sequence_.size()) return {};  // after its last slot
    const bool can_handle =
        handled_ < taken_ && now >= in_lane_[handled_ - consumed_].taken_at + setting_.table_latency;
    if (!can_handle) return {handled_ == 0 ? Wish::kIdle : Wish::kStarved};  // idle before its first slot
    return pixel_request(sequence_[handled_]);
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
    if (!has_table()) lut_port_took(now);  // the pixel port takes the slots itself
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

  bool has_table() const { return !setting_.table.empty(); }

  // The request of the port that takes slots: the LUT port, or the pixel port of a side without table.
  Request request_of_taker() const {
    if (taken_ == sequence_.size()) return {};  // after its last slot
    if (in_lane_.size() >= lane_fifo_slots_) return {Wish::kBlocked};
    const Slot& slot = sequence_[taken_];
    if (!has_table()) return pixel_request(slot);
    if (is_empty(slot)) return {Wish::kPass};
    return {Wish::kAccess, plain_word(setting_.table, slot.row, slot.column, width_)};
  }

  bool is_empty(const Slot& slot) const { return slot.row < 0 || slot.row > height_ - 1; }

  // Of the pixel port.
  Request pixel_request(const Slot& slot) const {
    if (is_empty(slot)) return {Wish::kPass};
    const std::optional<int> word = word_of(slot);
    if (!word) return {Wish::kPass};
    if (has_cache_ && !slot.begins && kept_[static_cast<std::size_t>(slot.k)] == word) return {Wish::kPass};
    const int words_of_row = width_ / 4;
    return {Wish::kAccess,
            plain_word(setting_.image, *word / words_of_row, *word % words_of_row, words_of_row)};
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
    std::optional<int>& kept = kept_[static_cast<std::size_t>(slot.k)];
    if (slot.begins) kept = std::nullopt;
    if (!is_empty(slot) && word_of(slot)) kept = word_of(slot);
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
  // `columns`: those that have slots.
  Matcher(const PlainCycleInput& input, std::int64_t columns)
      : is_(input), width_(input.width), height_(input.height), cycles_with_slots_(columns * is_.G) {
    const std::int64_t drain_columns = input.disparities - 1 + is_.r + is_.h;  // C_d
    const std::int64_t strips_ahead = input.fetch == PlainFetch::kColumn ? is_.w / is_.R : is_.r + is_.h;
    columns_ahead_ = drain_columns + strips_ahead * width_;
    drain_cycles_ = drain_columns * is_.G;
  }

  bool needs_slots() const { return cycles_with_slots_done_ < cycles_with_slots_; }
  // Whether the next consume-cycle, or the one that it works on, consumes a slot of lane p of each side.
  bool needs_slot_of(int p) const { return needs_slots() && cycles_of_column_ * is_.P + p < is_.K; }
  bool drains() const { return !needs_slots() && drain_cycles_done_ < drain_cycles_; }

  // It works on a consume-cycle for S cycles from `now` on.
  bool works() const { return began_.has_value(); }
  void begin(Cycle now) { began_ = now; }
  bool ends(Cycle now) const { return began_ && now == *began_ + is_.S - 1; }

  // Whether column C - 1 has been consumed.
  bool has_filled() const { return columns_consumed_ >= columns_ahead_; }
  // The end of a consume-cycle. Returns the rows in which it completes a result word, in their order.
  std::vector<int> consume() {
    began_.reset();
    ++(needs_slots() ? cycles_with_slots_done_ : drain_cycles_done_);
    ++cycles_of_column_;
    if (cycles_of_column_ < is_.G) return {};
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
  std::int64_t cycles_with_slots_;
  std::int64_t columns_ahead_ = 0;  // C
  std::int64_t drain_cycles_ = 0;
  std::optional<Cycle> began_;
  std::int64_t cycles_with_slots_done_ = 0;
  std::int64_t drain_cycles_done_ = 0;
  std::int64_t cycles_of_column_ = 0;
  std::int64_t columns_consumed_ = 0;
};

class ResultQueue {
 public:
  // `disparity`: the buffer of this frame.
  ResultQueue(const PlainCycleInput& input, PlainParts disparity)
      : disparity_(std::move(disparity)),
        capacity_(input.result_fifo_words),
        delay_(input.result_delay_cycles),
        words_of_frame_(input.width * input.height / 4),
        words_of_row_(input.width / 4),
        written_in_row_(static_cast<std::size_t>(input.height)) {}

  // A word has its place from the consume-cycle that completes it to its write. No other consume-cycle begins
  // before that one ends, so it is enough to take the place at its end.
  bool has_free_places(int places) const {
    return static_cast<std::int64_t>(words_.size()) + places <= capacity_;
  }
  bool all_written() const { return written_ == words_of_frame_; }
  Request result_port_request(Cycle now) const {
    if (words_.empty() || now <= words_.front().enters_at)
      return {written_ == 0 || all_written() ? Wish::kIdle : Wish::kStarved};
    const int row = words_.front().row;
    const std::int64_t word = written_in_row_[static_cast<std::size_t>(row)];
    return {Wish::kAccess,
            plain_word(disparity_, row, static_cast<int>(word), static_cast<int>(words_of_row_)),
            Direction::kWrite};
  }
  // Its consume-cycle ends in cycle `now`.
  void word_leaves_matcher(int row, Cycle now) { words_.push_back({row, now + delay_}); }
  // Returns its row if that is complete.
  std::optional<std::size_t> word_is_written() {
    const auto row = static_cast<std::size_t>(words_.front().row);
    words_.pop_front();
    ++written_;
    if (++written_in_row_[row] < words_of_row_) return std::nullopt;
    return row;
  }

 private:
  struct Word {
    int row;
    Cycle enters_at;  // at the end of this cycle
  };

  PlainParts disparity_;
  std::int64_t capacity_;
  Cycle delay_;  // Q
  std::int64_t words_of_frame_;
  std::int64_t words_of_row_;
  std::deque<Word> words_;  // in the queue, or on their way to it
  std::int64_t written_ = 0;
  std::vector<std::int64_t> written_in_row_;
};

}  // namespace

class PlainCore::Cycles {
 public:
  explicit Cycles(const PlainCycleInput& input)
      : input_(input),
        lanes_(static_cast<std::size_t>(input.lanes)),
        ports_(port_count(input)),
        places_(plain_places(input)) {
    for (int p = 0; p < input.lanes; ++p) sequences_.push_back(slots_of_a_frame(input, p));
    for (const PlainBank& bank : input.banks) {
      const BankPort port{BankAndArbiter(bank, input), {}};
      banks_.emplace_back(bank.kind == PlainBankKind::kQdr ? 2 : 1, port);
    }
    result_.names = plain_names(input.lanes);
    result_.ports.resize(ports_);
    result_.banks.resize(input.banks.size());
    result_.work.resize(input.banks.size());
    result_.counted_work.resize(input.banks.size());
    note_buffers();
    const int strips = (input.height + input.rows - 1) / input.rows;
    groups_ = static_cast<std::size_t>(input.width / 4);
    result_.tiles.resize(1 + static_cast<std::size_t>(strips) * groups_);
  }

  void start_frame(int frame) {
    const auto entry = static_cast<std::size_t>(frame);
    const std::size_t image = entry % input_.left_image.size();
    const std::array<Lane::Setting, 2> settings = {
        lane_setting(places_.left_lut, input_.left_table, places_.left_image[image]),
        lane_setting(places_.right_lut, input_.right_table, places_.right_image[image])};
    // Lane 0 has the first slot of each column.
    const auto columns = std::count_if(sequences_[0].begin(), sequences_[0].end(),
                                       [](const Slot& slot) { return slot.k == 0; });
    frame_.emplace(Matcher(input_, columns),
                   ResultQueue(input_, places_.disparity[entry % places_.disparity.size()]));
    frame_->rows.resize(static_cast<std::size_t>(input_.height));
    frame_->until_now.stalls.resize(ports_);
    frame_->strips.resize(1 + (result_.tiles.size() - 1) / groups_);
    for (std::size_t side = 0; side < 2; ++side) {
      for (const auto& sequence : sequences_)
        frame_->lanes[side].emplace_back(input_, sequence, settings[side]);
    }
    for (PlainStrip& strip : frame_->strips) {
      strip.accesses.resize(banks_.size());
      strip.lost.resize(ports_ + 2);
    }
  }

  bool runs() const { return frame_.has_value(); }

  bool step(Cycle now, const std::optional<PlainHostRequest>& host) {
    requests_.assign(ports_, {});
    if (frame_) {
      for (std::size_t side = 0; side < 2; ++side) {
        for (std::size_t p = 0; p < lanes_; ++p) {
          const Lane& lane = frame_->lanes[side][p];
          const bool has_port = side == 0 || !input_.joint_tables;
          if (has_port) requests_[lut_group(side, p)] = lane.lut_port_request();
          requests_[pixel_group(side, p)] = lane.pixel_port_request(now);
        }
      }
      requests_[result_port()] = frame_->queue.result_port_request(now);
    }
    if (host) {
      requests_[host_port()] = {Wish::kAccess, host->at, host->write ? Direction::kWrite : Direction::kRead};
      traffic_ = host->traffic;
    }
    arbitrate(now);
    const bool host_granted = granted_[host_port()];
    if (frame_) step_frame(now);
    return host_granted;
  }

  PlainCycleResult result(Cycle end) {
    PlainCycleResult result = result_;
    for (std::size_t bank = 0; bank < banks_.size(); ++bank) {
      BankAndArbiter& first = banks_[bank].front().arbiter;  // an sdram has one
      first.pass(end);
      result.work[bank].rows_opened = first.work().rows_opened;
      result.work[bank].refreshes = first.work().refreshes;
    }
    return result;
  }

 private:
  struct Frame {
    Frame(const Matcher& begun, const ResultQueue& empty) : matcher(begun), queue(empty) {}
    std::array<std::vector<Lane>, 2> lanes;  // left, right
    Matcher matcher;
    ResultQueue queue;
    std::vector<PlainRowEnd> rows;
    PlainRowEnd until_now;
    std::size_t tile = 0;  // of the next results
    std::vector<PlainStrip> strips;
  };
  // A bank, or a direction of a qdr bank: reads, then writes.
  struct BankPort {
    BankAndArbiter arbiter;
    std::vector<std::size_t> asked_by;  // in this cycle
  };

  // Where each buffer, or part of one that has rows, begins in its bank.
  void note_buffers() {
    buffer_at_.resize(input_.banks.size());
    std::vector<PlainParts> left_lut = {places_.left_lut};
    std::vector<PlainParts> right_lut = {input_.joint_tables ? PlainParts{} : places_.right_lut};
    std::size_t buffer = 0;
    for (const auto* list :
         {&places_.left_image, &places_.right_image, &places_.disparity, &left_lut, &right_lut}) {
      for (const PlainParts& parts : *list) {
        for (std::size_t part = 0; part < parts.size(); ++part) {
          if (plain_rows(parts.size(), part, input_.height) == 0) continue;
          buffer_at_[static_cast<std::size_t>(parts[part].bank)][parts[part].word] = buffer;
        }
      }
      ++buffer;
    }
    for (const auto& buffers : buffer_at_) result_.used_banks.push_back(!buffers.empty());
  }
  void note_work(const PlainWord& at) {
    const auto bank = static_cast<std::size_t>(at.bank);
    ++result_.work[bank].accesses;
    if (frame_) ++result_.counted_work[bank].accesses;
    ++result_.buffer_accesses[std::prev(buffer_at_[bank].upper_bound(at.word))->second];
  }

  std::size_t lut_group(std::size_t side, std::size_t p) const { return side * lanes_ + p; }
  std::size_t pixel_group(std::size_t side, std::size_t p) const { return (2 + side) * lanes_ + p; }
  std::size_t result_port() const { return 4 * lanes_; }
  std::size_t host_port() const { return 4 * lanes_ + 1; }

  Lane::Setting lane_setting(const PlainParts& table,
                             const std::optional<std::vector<std::uint32_t>>& entries,
                             const PlainParts& image) const {
    const auto latency = [this](const PlainParts& parts) {
      return parts.empty() ? 0
                           : plain_read_latency(input_.banks[static_cast<std::size_t>(parts.front().bank)]);
    };
    return {entries ? &*entries : nullptr, table, image, latency(table), latency(image)};
  }

  std::size_t strip_of(std::size_t tile) const { return tile == 0 ? 0 : 1 + (tile - 1) / groups_; }
  // Of a port or another cause.
  std::size_t waiter_of(std::size_t number) const {
    if (number == host_port()) return number + static_cast<std::size_t>(traffic_);
    return number < host_port() ? number : number + 2;
  }
  void note_loss(std::size_t port, std::size_t bank, std::size_t by) {
    ++result_.blame[{port, static_cast<int>(bank), by}];
    ++result_.tiles[frame_->tile].lost[{waiter_of(port), static_cast<int>(bank), waiter_of(by)}];
    ++frame_->strips[strip_of(frame_->tile)].lost[waiter_of(port)];
    ++frame_->until_now.stalls[port];
  }
  void note_access(std::size_t port, std::size_t bank) {
    const std::size_t kind = port == host_port() ? 1 + static_cast<std::size_t>(traffic_) : 0;
    ++frame_->strips[strip_of(frame_->tile)].accesses[bank][kind];
  }

  void step_frame(Cycle now) {
    Frame& frame = *frame_;
    bool slots_ready = true;
    for (const std::vector<Lane>& side : frame.lanes) {
      for (std::size_t p = 0; p < lanes_; ++p) {
        if (frame.matcher.needs_slot_of(static_cast<int>(p)) && !side[p].can_be_consumed(now))
          slots_ready = false;
      }
    }
    const bool begins = !frame.matcher.works() && frame.queue.has_free_places(input_.rows) &&
                        ((frame.matcher.needs_slots() && slots_ready) || frame.matcher.drains());
    if (begins) frame.matcher.begin(now);

    count_port_states();
    ++result_.counted_cycles;
    ++frame.until_now.cycles;
    ++frame.strips[strip_of(frame.tile)].cycles;
    ++result_.tiles[frame.tile].cycles;

    const auto acts = [&](std::size_t port) { return requests_[port].wish == Wish::kPass || granted_[port]; };
    if (acts(result_port())) {
      if (const auto row = frame.queue.word_is_written()) frame.rows[*row] = frame.until_now;
    }
    if (frame.matcher.ends(now)) {
      for (std::vector<Lane>& side : frame.lanes) {
        for (std::size_t p = 0; p < lanes_; ++p) {
          if (frame.matcher.needs_slot_of(static_cast<int>(p))) side[p].matcher_consumed();
        }
      }
      const std::vector<int> rows = frame.matcher.consume();
      for (const int row : rows) frame.queue.word_leaves_matcher(row, now);
      if (frame.tile == 0 ? frame.matcher.has_filled() : !rows.empty())
        frame.tile = std::min(frame.tile + 1, result_.tiles.size() - 1);
    }
    for (std::size_t side = 0; side < 2; ++side) {
      for (std::size_t p = 0; p < lanes_; ++p) {
        Lane& lane = frame.lanes[side][p];
        if (acts(pixel_group(side, p))) lane.pixel_port_handled(now);
        if (acts(lut_group(input_.joint_tables ? 0 : side, p))) lane.lut_port_took(now);
      }
    }
    if (!frame.queue.all_written()) return;
    result_.rows.push_back(frame.rows);
    result_.strips.push_back(frame.strips);
    frame_.reset();
  }

  // Decides every bank. Within a frame it counts bank states and blame.
  void arbitrate(Cycle now) {
    granted_.assign(ports_, false);
    for (auto& bank : banks_) {
      for (BankPort& port : bank) port.asked_by.clear();
    }
    for (std::size_t port = 0; port < ports_; ++port) {
      if (requests_[port].wish != Wish::kAccess) continue;
      auto& bank = banks_[static_cast<std::size_t>(requests_[port].at.bank)];
      (requests_[port].direction == Direction::kRead ? bank.front() : bank.back()).asked_by.push_back(port);
    }
    PlainBankStates not_counted;
    for (std::size_t bank = 0; bank < banks_.size(); ++bank) {
      PlainBankStates& states = frame_ ? result_.banks[bank] : not_counted;
      bool is_busy = false;
      bool is_contended = false;
      std::optional<std::size_t> cause;
      for (BankPort& bank_port : banks_[bank]) {
        const std::vector<std::size_t>& asked_by = bank_port.asked_by;
        if (asked_by.size() >= 2) is_contended = true;
        bank_port.arbiter.pass(now);
        const PlainBankWork before = bank_port.arbiter.work();
        const std::optional<std::size_t> outcome = bank_port.arbiter.decide(asked_by, requests_, now);
        if (frame_) {
          result_.counted_work[bank].rows_opened += bank_port.arbiter.work().rows_opened - before.rows_opened;
          result_.counted_work[bank].refreshes += bank_port.arbiter.work().refreshes - before.refreshes;
        }
        if (!outcome) continue;
        if (*outcome < ports_) {
          is_busy = true;
          granted_[*outcome] = true;
          ++(requests_[*outcome].direction == Direction::kRead ? states.reads : states.writes);
          note_work(requests_[*outcome].at);
          if (frame_) note_access(*outcome, bank);
        } else {
          cause = outcome;
        }
        for (const std::size_t port : asked_by) {
          if (frame_ && port != *outcome) note_loss(port, bank, *outcome);
        }
      }
      if (is_contended) ++states.contended;
      if (is_busy) {
        ++states.busy;
      } else if (!cause) {
        ++states.idle;
      } else {
        const std::array<std::uint64_t*, 3> of_causes = {&states.turnaround, &states.row, &states.refresh};
        ++*of_causes[*cause - ports_];
      }
    }
  }

  void count_port_states() {
    for (std::size_t port = 0; port < ports_; ++port) {
      PlainPortStates& states = result_.ports[port];
      switch (requests_[port].wish) {
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
          ++(granted_[port] ? states.granted : states.stalled);
          break;
      }
    }
  }

  const PlainCycleInput& input_;
  std::size_t lanes_;  // P
  std::size_t ports_;
  PlainPlaces places_;
  std::vector<std::vector<Slot>> sequences_;  // [p]
  std::vector<std::vector<BankPort>> banks_;
  std::vector<Request> requests_;  // [port], in this cycle
  std::vector<bool> granted_;
  PlainTraffic traffic_ = PlainTraffic::kReadBack;
  std::vector<std::map<std::uint64_t, std::size_t>> buffer_at_;  // [bank], by its first word
  std::size_t groups_ = 0;                                       // of four columns, in a strip
  std::optional<Frame> frame_;                                   // that runs, until its last result write
  PlainCycleResult result_;
};

PlainCore::PlainCore(const PlainCycleInput& input) : cycles_(std::make_unique<Cycles>(input)) {}
PlainCore::~PlainCore() = default;
void PlainCore::start_frame(int frame) { cycles_->start_frame(frame); }
bool PlainCore::runs() const { return cycles_->runs(); }
bool PlainCore::step(std::int64_t now, const std::optional<PlainHostRequest>& host) {
  return cycles_->step(now, host);
}
PlainCycleResult PlainCore::result(std::int64_t end) { return cycles_->result(end); }

std::vector<std::string> plain_names(int lanes) {
  std::vector<std::string> names;
  for (const PlainPort group :
       {PlainPort::kLeftLut, PlainPort::kRightLut, PlainPort::kLeftPixel, PlainPort::kRightPixel}) {
    for (int p = 0; p < lanes; ++p)
      names.push_back(name_of(group) + (lanes == 1 ? "" : "." + std::to_string(p)));
  }
  for (const char* name : {"result", "host", "turnaround", "row", "refresh"}) names.emplace_back(name);
  return names;
}

}  // namespace stereotlm::test
