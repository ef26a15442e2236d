#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace stereotlm {

// The byte addresses of a buffer.
struct AddressRange {
  std::uint64_t first = 0;
  std::uint64_t end = 0;  // the first byte behind the range

  bool contains(std::uint64_t address) const { return first <= address && address < end; }
  bool overlaps(const AddressRange& other) const { return first < other.end && other.first < end; }
};

// Counts 32-bit words by the range in which they begin. The ranges do not overlap. Plain C++.
class WordsByRange {
 public:
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
  // Words of each range, in the order of the ranges, then the words outside all ranges.
  const std::vector<std::uint64_t>& words() const { return words_; }
  std::uint64_t total() const { return std::accumulate(words_.begin(), words_.end(), std::uint64_t{0}); }

 private:
  std::size_t find(std::uint64_t address) const {
    std::size_t range = 0;
    while (range < ranges_.size() && !ranges_[range].contains(address)) ++range;
    return range;
  }
  // `address` belongs to latest_. The first address behind it that does not; kNone: there is none.
  std::uint64_t border_behind(std::uint64_t address) const {
    if (latest_ < ranges_.size()) return ranges_[latest_].end;
    std::uint64_t border = kNone;
    for (const AddressRange& range : ranges_) {
      if (range.first > address) border = std::min(border, range.first);
    }
    return border;
  }
  // Consecutive words from `address` on that begin before `end`.
  static std::uint64_t words_until(std::uint64_t end, std::uint64_t address) {
    return (end - address - 1) / 4 + 1;
  }

  static constexpr std::uint64_t kNone = UINT64_MAX;

  std::vector<AddressRange> ranges_;
  std::vector<std::uint64_t> words_;
  std::size_t latest_;  // range of the last word counted, which the next word mostly shares
};

}  // namespace stereotlm
