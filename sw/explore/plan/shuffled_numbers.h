#pragma once

#include <cstdint>

namespace stereotlm::explore {

// The numbers 0..size-1 in an order that depends on a seed. at() computes each number by itself: a Feistel
// network permutes the numbers of the smallest even number of bits that suffices, and is applied again until
// the result is below `size`. size: 1..2^62.
class ShuffledNumbers {
 public:
  ShuffledNumbers(std::uint64_t size, std::uint64_t seed);
  std::uint64_t at(std::uint64_t place) const;  // place: 0..size-1

 private:
  std::uint64_t permuted(std::uint64_t number) const;

  std::uint64_t size_;
  std::uint64_t seed_;
  unsigned half_bits_ = 1;
};

}  // namespace stereotlm::explore
