#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

// The resources that parts of a circuit take on a Virtex-II FPGA (Xilinx DS031).
namespace stereotlm::area {

inline constexpr int kPixelBits = 8;             // of a grey level
inline constexpr std::int64_t kMostPixel = 255;  // the greatest grey level

// The numbers of the device's elements that a part takes.
struct Resources {
  std::int64_t luts = 0;         // 4-input look-up tables
  std::int64_t flip_flops = 0;   // each shares the place of the LUT in front of it, if there is one
  std::int64_t block_rams = 0;   // of 18 kbit, dual port
  std::int64_t multipliers = 0;  // multipliers of 18 x 18 bits

  Resources& operator+=(const Resources& other) {  // adds number by number
    luts += other.luts;
    flip_flops += other.flip_flops;
    block_rams += other.block_rams;
    multipliers += other.multipliers;
    return *this;
  }
};
inline Resources operator+(Resources one, const Resources& other) { return one += other; }  // sum
inline Resources operator*(std::int64_t count, const Resources& each) {  // of `count` equal parts
  return {count * each.luts, count * each.flip_flops, count * each.block_rams, count * each.multipliers};
}

// The values that a number may take; low <= 0 <= high.
struct Range {
  std::int64_t low = 0;   // the least value
  std::int64_t high = 0;  // the greatest value
};

// The fewest bits that hold 0..largest; 0 bits for 0.
inline int bits_of(std::int64_t largest) {
  int bits = 0;
  for (; largest > 0; largest /= 2) ++bits;
  return bits;
}
// The fewest bits that hold every value of a range. If no value is positive, the bits hold the magnitude,
// which the circuit subtracts.
inline int bits_of(Range range) {
  if (range.low >= 0) return bits_of(range.high);
  if (range.high <= 0) return bits_of(-range.low);
  return 1 + std::max(bits_of(range.high), bits_of(-range.low - 1));
}

// part / whole, rounded up.
constexpr std::int64_t ceil_of(std::int64_t part, std::int64_t whole) { return (part + whole - 1) / whole; }

// An adder or a subtracter: one LUT on the carry chain for each bit of the result.
inline Resources adder(int bits) { return {bits}; }
// Tests whether one number is less than another, by the borrow of their difference: one LUT more than a
// subtracter.
inline Resources comparator(int bits) { return {bits + 1}; }
// Selects one of two numbers: one LUT per bit.
inline Resources selector(int bits) { return {bits}; }
// Selects one of several numbers: one LUT per bit for every two numbers. The multiplexers of the slices
// (MUXF5 to MUXF8) join these LUTs for up to 32 numbers. For more numbers, a further multiplexer selects
// among the groups of 32.
inline Resources multiplexer(int numbers, int bits) {
  constexpr int kMultiplexerInputs = 32;  // of the largest multiplexer in slices, which MUXF8 completes
  if (numbers == 1) return {};
  const Resources groups{ceil_of(numbers, 2) * bits};
  return groups + multiplexer(static_cast<int>(ceil_of(numbers, kMultiplexerInputs)), bits);
}
// Tests whether two numbers are equal: each LUT compares two bits of both, the carry chain joins the LUTs.
inline Resources equality(int bits) { return {ceil_of(bits, 2)}; }
// |a - b|: a comparison, both differences, and one LUT per bit that selects.
inline Resources absolute_difference(int bits) { return 4 * Resources{bits}; }
// Sums `count` numbers of 0..most in one cycle, in a tree of adders.
inline Resources adder_tree(int count, std::int64_t most) {
  if (count == 1) return {};
  const int half = count / 2;
  return adder_tree(half, most) + adder_tree(count - half, most) + adder(bits_of(most * count));
}
// Multiplies two magnitudes. A multiplier of the device takes 17 bits of each. Longer numbers are multiplied
// in parts, and the products of the parts are added.
inline Resources product(int bits, int other_bits) {
  constexpr int kMultiplierBits = 17;
  const std::int64_t parts = ceil_of(bits, kMultiplierBits) * ceil_of(other_bits, kMultiplierBits);
  return Resources{0, 0, 0, parts} + (parts - 1) * adder(bits + other_bits - kMultiplierBits);
}
// radix * high + low, where low < radix: a multiplier and an adder. A radix that is a power of two takes no
// logic: the bits of `low` follow those of `high`.
inline Resources digits(int radix, int bits) {
  const bool is_power_of_two = bits_of(radix) != bits_of(radix - 1);
  return is_power_of_two ? Resources{} : Resources{0, 0, 0, 1} + adder(bits);
}
// Holds a number until the next clock enable: one flip-flop per bit.
inline Resources registers(int bits) { return {0, bits}; }
// Delays a number by `length` clock enables. A length of 1 takes one flip-flop per bit. A longer register
// takes one SRL16 per bit for every 16 places.
inline Resources shift_register(int length, int bits) {
  return length == 1 ? registers(bits) : Resources{ceil_of(length, 16) * bits};
}
// A memory of LUTs with a write port and a read port, which answers in the same cycle: two LUTs per bit for
// 16, 32 or 64 words; for more words a multiplexer joins memories of 64.
inline Resources lut_memory(int words, int bits) {
  int deep = 16;
  while (deep < words && deep < 64) deep *= 2;
  const auto groups = static_cast<int>(ceil_of(words, deep));
  return Resources{2 * deep / 16 * groups * bits} + multiplexer(groups, bits);
}
// A queue of pixels or table entries. What arrives may leave in the same cycle.
inline Resources queue(int slots, int bits) {
  constexpr Resources kQueueControl{28, 17};  // of 16 slots: block queue
  return (slots == 1 ? registers(bits) : lut_memory(slots, bits)) + selector(bits) + kQueueControl;
}
// A memory with a write port and a read port: block RAMs side by side, each 512 x 36, or deeper and narrower
// (1K x 18, 2K x 9, 4K x 4, 8K x 2, 16K x 1) so that no multiplexer is needed.
inline Resources memory(int words, int bits) {
  using Shape = std::pair<int, int>;  // words, bits
  constexpr std::array<Shape, 6> kShapes = {
      {{512, 36}, {1024, 18}, {2048, 9}, {4096, 4}, {8192, 2}, {16384, 1}}};
  const auto deep_enough = std::find_if(kShapes.begin(), kShapes.end() - 1,
                                        [words](const Shape& shape) { return words <= shape.first; });
  return {0, 0, ceil_of(words, deep_enough->first) * ceil_of(bits, deep_enough->second), 0};
}

}  // namespace stereotlm::area
