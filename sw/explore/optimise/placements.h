#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "platform/config/board_config.h"

namespace stereotlm::explore {

// Every different way to put the buffers of a board into its banks, that keeps the rules of boards. Banks
// that nothing but the name tells apart are alike. Of ways that differ by an exchange of banks that are
// alike, there is one: the one whose buffers use such banks in the order of the board. The ways come in the
// order of the first buffer's banks, then of the second buffer's, and so on; a stripe of some banks comes
// before longer ones that begin with them.
//
// The board's own allocation gives the lengths of the lists and says which tables there are.
class Placements {
 public:
  static constexpr std::size_t kMost = 5'000'000;

  // most_banks: that a placement uses. most_parts: of a buffer; 1: each buffer is in one bank. Throws
  // std::length_error if there are more than kMost placements.
  Placements(const platform::BoardConfig& board, int most_banks, int most_parts);
  // The board's own placement alone.
  explicit Placements(const platform::BoardConfig& board);

  std::size_t size() const { return used_.size(); }
  // `board` with its buffers placed. It differs from the board of the constructor only in keys that do not
  // change key().
  platform::BoardConfig placed(const platform::BoardConfig& board, std::size_t number) const;

  // Placements that use as many banks of each kind, and have as many parts of each buffer, have the same
  // number, 0..uses()-1: they have the same pins and the same area.
  std::uint32_t use(std::size_t number) const { return used_[number]; }
  std::size_t uses() const { return first_of_use_.size(); }
  std::size_t first_of_use(std::uint32_t use) const { return first_of_use_[use]; }

  // Frames of one turn of the lists. Frames whose buffers lie alike have the same number, 0..ways()-1.
  std::size_t turn() const { return turn_; }
  std::uint32_t way(std::size_t number, std::size_t frame) const { return ways_[number * turn_ + frame]; }
  std::size_t ways() const { return of_way_.size(); }
  // A board that has the buffers of such a frame alone.
  platform::BoardConfig board_of_way(const platform::BoardConfig& board, std::uint32_t way) const;

  // Placements with the same use and the same ways, in whatever order of the frames.
  struct Group {
    std::uint32_t use;
    std::vector<std::uint32_t> ways;  // of each frame of a turn, sorted
    std::vector<std::uint32_t> placements;
  };
  const std::vector<Group>& groups() const { return groups_; }

  // Boards with the same text have the same placements, with the same numbers.
  static std::string key(const platform::BoardConfig& board);

 private:
  using Banks = std::vector<std::vector<int>>;  // [buffer][part]
  class Builder;

  Banks banks(std::size_t number) const;
  void group();

  std::size_t buffers_ = 0;
  std::size_t most_parts_;
  std::size_t turn_;
  std::vector<std::uint8_t> banks_;  // [placement][buffer][part]; kNone behind the last part
  std::vector<std::uint32_t> used_;  // [placement]
  std::vector<std::size_t> first_of_use_;
  std::vector<std::uint32_t> ways_;  // [placement][frame]
  std::vector<Banks> of_way_;        // [way], of one buffer for each list and table
  std::vector<Group> groups_;        // in the order of their first placements
};

}  // namespace stereotlm::explore
