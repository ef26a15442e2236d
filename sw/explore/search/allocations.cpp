#include "sw/explore/search/allocations.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "models/memory/arbitration_policies.h"
#include "platform/config/buffer_layout.h"

namespace stereotlm::explore {
namespace {

using platform::BankConfig;
using platform::BoardConfig;
using platform::PlacedBuffer;

bool are_alike(const BankConfig& a, const BankConfig& b) {
  return a.words == b.words && a.kind == b.kind && a.turnaround_cycles == b.turnaround_cycles;
}

class Placements {
 public:
  Placements(const BoardConfig& board, int most_banks, const std::function<void(const Placement&)>& visit)
      : board_(board),
        most_banks_(most_banks),
        visit_(visit),
        buffers_(platform::buffers(board).size()),
        used_(board.banks.size()) {}

  void place_next() {
    if (placement_.size() == buffers_) return visit_(placement_);
    for (std::size_t bank = 0; bank < board_.banks.size(); ++bank) {
      if (used_[bank] == 0 && (banks_ == most_banks_ || !is_first_of_its_kind(bank))) continue;
      if (used_[bank]++ == 0) ++banks_;
      placement_.push_back(static_cast<int>(bank));
      place_next();
      placement_.pop_back();
      if (--used_[bank] == 0) --banks_;
    }
  }

 private:
  // Whether no unused bank before `bank` is like it.
  bool is_first_of_its_kind(std::size_t bank) const {
    for (std::size_t other = 0; other < bank; ++other) {
      if (used_[other] == 0 && are_alike(board_.banks[other], board_.banks[bank])) return false;
    }
    return true;
  }

  const BoardConfig& board_;
  int most_banks_;
  const std::function<void(const Placement&)>& visit_;
  std::size_t buffers_;
  std::vector<int> used_;  // [bank]: number of buffers in it
  int banks_ = 0;          // number of banks with buffers
  Placement placement_;
};

// Replaces each bank by the first bank that is like it and does not replace another.
class FirstBanks {
 public:
  explicit FirstBanks(const BoardConfig& board) : board_(board) {}

  const std::string& name(int bank) {
    const auto known = taken_.find(bank);
    if (known != taken_.end()) return board_.banks[static_cast<std::size_t>(known->second)].name;
    for (std::size_t other = 0;; ++other) {
      const auto place = static_cast<int>(other);
      if (given_.count(place) > 0 ||
          !are_alike(board_.banks[other], board_.banks[static_cast<std::size_t>(bank)]))
        continue;
      given_.insert(place);
      taken_[bank] = place;
      return board_.banks[other].name;
    }
  }

 private:
  const BoardConfig& board_;
  std::map<int, int> taken_;  // [bank]: the bank that replaces it
  std::set<int> given_;       // banks that replace a bank
};

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
  Placements(board, most_banks, visit).place_next();
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
                      [](const BankConfig& bank) { return bank.turnaround_cycles > 0; });
}

BoardConfig board_of_frame(const BoardConfig& board, const Placement& placement, std::uint64_t frame) {
  BoardConfig result = board;
  result.name = "one frame of " + board.name;
  FirstBanks banks(board);
  std::size_t first = 0;  // index in the placement of the list's first buffer, or of the table
  platform::AllocationConfig& allocation = result.allocation;
  for (auto* list : {&allocation.left_image, &allocation.right_image, &allocation.disparity}) {
    const std::size_t length = list->size();
    *list = {banks.name(placement[first + frame % length])};
    first += length;
  }
  for (auto* table : {&allocation.left_lut, &allocation.right_lut}) {
    if (*table && first < placement.size()) *table = banks.name(placement[first++]);
  }
  if (board.fpga.joint_tables) allocation.right_lut = allocation.left_lut;
  return result;
}

std::string allocation_text(const platform::BoardConfig& board) {
  std::string text;
  std::optional<platform::Buffer> last;
  for (const PlacedBuffer& buffer : platform::buffers(board)) {
    if (buffer.buffer != last) text += (text.empty() ? "" : ", ") + std::string(name_of(buffer.buffer));
    text += ' ' + buffer.bank;
    last = buffer.buffer;
  }
  return text;
}

}  // namespace stereotlm::explore
