#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "models/address_range.h"

namespace stereotlm {

// Counts 32-bit words, separately for each of several address ranges that do not overlap. A word belongs to
// the range in which its first byte lies. LocalBusControl and BridgeControl count the words written to each
// buffer with it. Plain C++.
class WordsByRange {
 public:
  // No range overlaps another.
  explicit WordsByRange(std::vector<AddressRange> ranges)
      : ranges_(std::move(ranges)), words_(ranges_.size() + 1), latest_(ranges_.size()) {}

  // Counts consecutive words, the first of them at `address`.
  void add(std::uint64_t address, std::uint64_t words) {
    while (words > 0) {
      if (latest_ == ranges_.size() || !ranges_[latest_].contains(address)) latest_ = find(address);
      const std::uint64_t here = std::min(words, words_until(border_behind(address), address));
      words_[latest_] += here;
      words -= here;
      address += 4 * here;
    }
  }
  // [range]: the words counted in it. The last element counts the words outside all ranges.
  const std::vector<std::uint64_t>& words() const { return words_; }
  std::uint64_t total() const { return std::accumulate(words_.begin(), words_.end(), std::uint64_t{0}); }

 private:
  std::size_t find(std::uint64_t address) const {
    std::size_t range = 0;
    while (range < ranges_.size() && !ranges_[range].contains(address)) ++range;
    return range;
  }
  // Returns the first address behind `address` that is in another range; kNone if there is none. `address`
  // must be in the range latest_.
  std::uint64_t border_behind(std::uint64_t address) const {
    if (latest_ < ranges_.size()) return ranges_[latest_].end;
    std::uint64_t border = kNone;
    for (const AddressRange& range : ranges_) {
      if (range.first > address) border = std::min(border, range.first);
    }
    return border;
  }
  // The number of consecutive words from `address` on that begin before `end`.
  static std::uint64_t words_until(std::uint64_t end, std::uint64_t address) {
    return (end - address - 1) / 4 + 1;
  }

  static constexpr std::uint64_t kNone = UINT64_MAX;

  std::vector<AddressRange> ranges_;
  std::vector<std::uint64_t> words_;
  std::size_t latest_;  // index of the range of the last word counted, in which the next word mostly is too
};

}  // namespace stereotlm
