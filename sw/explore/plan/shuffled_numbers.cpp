#include "sw/explore/plan/shuffled_numbers.h"

#include "calib/split_mix.h"

namespace stereotlm::explore {

ShuffledNumbers::ShuffledNumbers(std::uint64_t size, std::uint64_t seed) : size_(size), seed_(seed) {
  while (std::uint64_t{1} << 2 * half_bits_ < size) ++half_bits_;
}

std::uint64_t ShuffledNumbers::at(std::uint64_t place) const {
  std::uint64_t number = permuted(place);
  while (number >= size_) number = permuted(number);
  return number;
}

std::uint64_t ShuffledNumbers::permuted(std::uint64_t number) const {
  constexpr std::uint64_t kRounds = 6;
  const std::uint64_t mask = (std::uint64_t{1} << half_bits_) - 1;
  std::uint64_t left = number >> half_bits_;
  std::uint64_t right = number & mask;
  for (std::uint64_t round = 0; round < kRounds; ++round) {
    const std::uint64_t key = calib::mixed(seed_ + (round + 1) * calib::kSplitMixStep);
    const std::uint64_t next = left ^ (calib::mixed(right ^ key) & mask);
    left = right;
    right = next;
  }
  return left << half_bits_ | right;
}

}  // namespace stereotlm::explore
