#include "sw/explore/optimise/placements.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <stdexcept>

#include "models/memory/memory_config.h"
#include "platform/config/board_reader.h"
#include "platform/config/board_yaml.h"
#include "platform/config/buffer_layout.h"

namespace stereotlm::explore {
namespace {

using platform::BankConfig;
using platform::BoardConfig;

constexpr std::uint8_t kNone = 255;

bool are_alike(BankConfig a, const BankConfig& b) {
  a.name = b.name;
  return a.words == b.words && a.kind == b.kind && a.turnaround_cycles == b.turnaround_cycles &&
         a.sdram == b.sdram && a.standby_mw == b.standby_mw && a.access_pj == b.access_pj &&
         a.row_pj == b.row_pj && a.refresh_pj == b.refresh_pj;
}

platform::BufferBanks named(const BoardConfig& board, const std::vector<int>& banks) {
  std::vector<std::string> names;
  for (const int bank : banks) names.push_back(board.banks[static_cast<std::size_t>(bank)].name);
  return platform::BufferBanks(names);
}

// The lengths of the lists, and 1 for each table, in the order of platform::Buffer; joint tables are one.
std::array<std::size_t, 5> lengths_of(const BoardConfig& board) {
  const platform::AllocationConfig& in = board.allocation;
  return {in.left_image.size(), in.right_image.size(), in.disparity.size(), in.left_lut ? 1U : 0U,
          in.right_lut && !board.fpga.joint_tables ? 1U : 0U};
}

// Puts the buffers, in the order of platform::buffers(), into banks.
void place(BoardConfig& board, const std::vector<std::vector<int>>& banks) {
  const std::array<std::size_t, 5> lengths = lengths_of(board);
  platform::AllocationConfig& allocation = board.allocation;
  auto next = banks.begin();
  for (auto* list : {&allocation.left_image, &allocation.right_image, &allocation.disparity}) {
    for (platform::BufferBanks& buffer : *list) buffer = named(board, *next++);
  }
  if (lengths[3] > 0) allocation.left_lut = named(board, *next++);
  if (lengths[4] > 0) allocation.right_lut = named(board, *next++);
  if (board.fpga.joint_tables) allocation.right_lut = allocation.left_lut;
}

}  // namespace

class Placements::Builder {
 public:
  Builder(Placements& all, const BoardConfig& board, int most_banks)
      : all_(all), board_(board), most_banks_(most_banks), used_(board.banks.size()) {
    const std::vector<memory::SsramBankConfig> configs = ssram_configs(board);
    for (std::size_t bank = 0; bank < board.banks.size(); ++bank) {
      std::size_t kind = 0;
      while (!are_alike(board.banks[kind], board.banks[bank])) ++kind;
      kinds_.push_back(kind);
      latencies_.push_back(memory::read_latency_cycles(configs[bank]));
      free_words_.push_back(board.banks[bank].words);
    }
    const std::array<std::size_t, 5> lengths = lengths_of(board);
    for (std::size_t buffer = 0; buffer < lengths.size(); ++buffer) {
      firsts_.push_back(buffers_.size());
      for (std::size_t i = 0; i < lengths[buffer]; ++i) buffers_.push_back(buffer);
    }
    lengths_ = {lengths.begin(), lengths.end()};
    all_.buffers_ = buffers_.size();
  }

  // Throws std::length_error if there are too many.
  void build() {
    if (!has_package()) {  // else some of them are none
      counts_alone_ = true;
      place_next();
      counts_alone_ = false;
    }
    place_next();
  }
  // The placement that the board has, without a check.
  void take_own() {
    for (const platform::PlacedBuffer& part : platform::buffers(board_)) {
      const auto bank = std::find_if(board_.banks.begin(), board_.banks.end(),
                                     [&part](const BankConfig& one) { return one.name == part.bank; });
      if (part.part == 0) placed_.emplace_back();
      placed_.back().push_back(static_cast<int>(bank - board_.banks.begin()));
      take(static_cast<std::size_t>(placed_.back().back()));
    }
    add();
  }

 private:
  // Whether no unused bank before this one is like it.
  bool is_first_of_its_kind(std::size_t bank) const {
    for (std::size_t other = kinds_[bank]; other < bank; ++other) {
      if (kinds_[other] == kinds_[bank] && used_[other] == 0) return false;
    }
    return true;
  }

  // The words of a part of the next buffer, as platform::buffer_words().
  std::int64_t words(std::size_t part, std::size_t parts) const {
    const auto rows = (static_cast<std::size_t>(board_.image.height) - part + parts - 1) / parts;
    const auto columns = static_cast<std::size_t>(board_.image.width);
    const bool is_table = buffers_[placed_.size()] >= static_cast<std::size_t>(platform::Buffer::kLeftLut);
    return static_cast<std::int64_t>(rows * (is_table ? columns : columns / 4));
  }

  void place_next() {
    if (placed_.size() == buffers_.size()) return add();
    std::vector<int> banks;
    extend(banks);
  }

  // Places the next buffer in these banks and in each of the longer stripes that begin with them.
  void extend(std::vector<int>& banks) {
    if (!banks.empty()) place_in(banks);
    if (banks.size() == all_.most_parts_ || banks.size() == static_cast<std::size_t>(board_.image.height))
      return;
    for (std::size_t bank = 0; bank < used_.size(); ++bank) {
      const auto number = static_cast<int>(bank);
      if (used_[bank] == 0 && (banks_ == most_banks_ || !is_first_of_its_kind(bank))) continue;
      if (std::find(banks.begin(), banks.end(), number) != banks.end()) continue;
      if (!banks.empty() && latencies_[static_cast<std::size_t>(banks.front())] != latencies_[bank]) continue;
      take(bank);
      banks.push_back(number);
      extend(banks);
      banks.pop_back();
      leave(bank);
    }
  }

  void take(std::size_t bank) {
    if (used_[bank]++ == 0) ++banks_;
  }
  void leave(std::size_t bank) {
    if (--used_[bank] == 0) --banks_;
  }

  // The next buffer in exactly these banks, if they have room.
  void place_in(const std::vector<int>& banks) {
    bool has_room = true;
    for (std::size_t part = 0; part < banks.size(); ++part) {
      std::int64_t& left = free_words_[static_cast<std::size_t>(banks[part])];
      left -= words(part, banks.size());
      has_room = has_room && left >= 0;
    }
    if (has_room) {
      placed_.push_back(banks);
      place_next();
      placed_.pop_back();
    }
    for (std::size_t part = 0; part < banks.size(); ++part)
      free_words_[static_cast<std::size_t>(banks[part])] += words(part, banks.size());
  }

  void add() {
    if (counts_alone_) return check_count(count_++);
    if (has_package()) {
      BoardConfig board = board_;
      place(board, placed_);
      if (!broken_rules(board, [](const std::string&) { return true; }).empty()) return;
    }
    check_count(all_.size());
    for (const std::vector<int>& banks : placed_) {
      for (std::size_t part = 0; part < all_.most_parts_; ++part)
        all_.banks_.push_back(part < banks.size() ? static_cast<std::uint8_t>(banks[part]) : kNone);
    }
    add_use();
    for (std::size_t frame = 0; frame < all_.turn_; ++frame) add_way(frame);
  }

  static void check_count(std::size_t before) {
    if (before == kMost) throw std::length_error(fmt::format("more than {} different placements", kMost));
  }
  bool has_package() const { return !board_.fpga.package.empty(); }

  void add_use() {
    std::vector<std::size_t> count(kinds_.size());  // [kind]: banks used
    for (std::size_t bank = 0; bank < used_.size(); ++bank) count[kinds_[bank]] += used_[bank] > 0 ? 1 : 0;
    for (const std::vector<int>& banks : placed_) count.push_back(banks.size());
    const auto [known, is_new] = uses_.emplace(count, all_.first_of_use_.size());
    if (is_new) all_.first_of_use_.push_back(all_.used_.size());
    all_.used_.push_back(static_cast<std::uint32_t>(known->second));
  }

  // Renames the banks of the frame: each to the first one like it that the frame has not used yet.
  void add_way(std::size_t frame) {
    Banks of_frame;
    std::map<int, int> names;
    std::map<std::size_t, std::size_t> next;  // [kind]
    for (std::size_t buffer = 0; buffer < lengths_.size(); ++buffer) {
      if (lengths_[buffer] == 0) continue;
      of_frame.push_back(placed_[firsts_[buffer] + frame % lengths_[buffer]]);
      for (int& bank : of_frame.back()) {
        const auto [name, is_new] = names.emplace(bank, 0);
        if (is_new) {
          const std::size_t kind = kinds_[static_cast<std::size_t>(bank)];
          std::size_t& other = next.emplace(kind, kind).first->second;
          while (kinds_[other] != kind) ++other;
          name->second = static_cast<int>(other++);
        }
        bank = name->second;
      }
    }
    const auto [known, is_new] = ways_.emplace(of_frame, all_.of_way_.size());
    if (is_new) all_.of_way_.push_back(of_frame);
    all_.ways_.push_back(static_cast<std::uint32_t>(known->second));
  }

  Placements& all_;
  const BoardConfig& board_;
  int most_banks_;
  std::vector<std::size_t> kinds_;        // [bank]: the first bank that is like it
  std::vector<int> latencies_;            // [bank]
  std::vector<std::size_t> buffers_;      // [buffer]: number of its list or table
  std::vector<std::size_t> lengths_;      // [list or table]
  std::vector<std::size_t> firsts_;       // [list or table]: number of its first buffer
  std::vector<int> used_;                 // [bank]: parts in it
  std::vector<std::int64_t> free_words_;  // [bank]
  int banks_ = 0;                         // used
  bool counts_alone_ = false;
  std::size_t count_ = 0;
  Banks placed_;
  std::map<std::vector<std::size_t>, std::size_t> uses_;
  std::map<Banks, std::size_t> ways_;
};

Placements::Placements(const BoardConfig& board, int most_banks, int most_parts)
    : most_parts_(static_cast<std::size_t>(most_parts)), turn_(allocation_period_frames(board)) {
  Builder(*this, board, most_banks).build();
  group();
}

Placements::Placements(const BoardConfig& board)
    : most_parts_(fpga::kStripeRule.max), turn_(allocation_period_frames(board)) {
  Builder(*this, board, static_cast<int>(board.banks.size())).take_own();
  group();
}

void Placements::group() {
  std::map<std::pair<std::uint32_t, std::vector<std::uint32_t>>, std::size_t> known;
  for (std::size_t number = 0; number < size(); ++number) {
    const auto first = ways_.begin() + static_cast<std::ptrdiff_t>(number * turn_);
    std::vector<std::uint32_t> ways(first, first + static_cast<std::ptrdiff_t>(turn_));
    std::sort(ways.begin(), ways.end());
    const auto [group, is_new] = known.emplace(std::pair(use(number), ways), groups_.size());
    if (is_new) groups_.push_back({use(number), std::move(ways), {}});
    groups_[group->second].placements.push_back(static_cast<std::uint32_t>(number));
  }
}

Placements::Banks Placements::banks(std::size_t number) const {
  Banks all(buffers_);
  const std::uint8_t* next = banks_.data() + number * buffers_ * most_parts_;
  for (std::vector<int>& of_buffer : all) {
    for (std::size_t part = 0; part < most_parts_; ++part, ++next) {
      if (*next != kNone) of_buffer.push_back(*next);
    }
  }
  return all;
}

BoardConfig Placements::placed(const BoardConfig& board, std::size_t number) const {
  BoardConfig result = board;
  place(result, banks(number));
  return result;
}

BoardConfig Placements::board_of_way(const BoardConfig& board, std::uint32_t way) const {
  BoardConfig result = board;
  platform::AllocationConfig& allocation = result.allocation;
  for (auto* list : {&allocation.left_image, &allocation.right_image, &allocation.disparity})
    list->resize(1, list->front());
  place(result, of_way_[way]);
  return result;
}

std::string Placements::key(const BoardConfig& board) {
  const std::array<std::size_t, 5> lengths = lengths_of(board);
  BoardConfig like;  // with the default of each key that does not matter
  like.image = board.image;
  like.banks = board.banks;
  like.fpga.joint_tables = board.fpga.joint_tables;
  like.fpga.device = board.fpga.device;
  like.fpga.package = board.fpga.package;
  like.allocation = board.allocation;
  std::vector<std::vector<int>> first(lengths[0] + lengths[1] + lengths[2] + lengths[3] + lengths[4], {0});
  place(like, first);
  return platform::to_yaml(like);
}

}  // namespace stereotlm::explore
