#pragma once

#include <cstdint>

// The resources that parts of a circuit take on a Virtex-II FPGA (Xilinx DS031).
namespace stereotlm::area {

inline constexpr int kPixelBits = 8;
inline constexpr std::int64_t kMostPixel = 255;

struct Resources {
  std::int64_t luts = 0;        // 4-input look-up tables
  std::int64_t flip_flops = 0;  // each shares the place of the LUT in front of it, if there is one
  std::int64_t block_rams = 0;  // of 18 kbit, dual port
  std::int64_t multipliers = 0;

  Resources& operator+=(const Resources& other);
};
Resources operator+(Resources one, const Resources& other);
Resources operator*(std::int64_t count, const Resources& each);

// The values that a number may take; low <= 0 <= high.
struct Range {
  std::int64_t low = 0;
  std::int64_t high = 0;
};

// The fewest bits that hold 0..largest; 0 bits for 0.
int bits_of(std::int64_t largest);
// The fewest bits that hold every value of a range. If no value is positive, the bits hold the magnitude,
// which the circuit subtracts.
int bits_of(Range range);

// An adder or a subtracter: one LUT on the carry chain for each bit of the result.
Resources adder(int bits);
// Tests whether one number is less than another, by the borrow of their difference: one LUT more than a
// subtracter.
Resources comparator(int bits);
// Selects one of two numbers: one LUT per bit.
Resources selector(int bits);
// Selects one of several numbers: one LUT per bit for every two numbers. The multiplexers of the slices
// (MUXF5 to MUXF8) join these LUTs for up to 32 numbers. For more numbers, a further multiplexer selects
// among the groups of 32.
Resources multiplexer(int numbers, int bits);
// Tests whether two numbers are equal: each LUT compares two bits of both, the carry chain joins the LUTs.
Resources equality(int bits);
// |a - b|: the difference with its borrow, and one LUT per bit that negates it.
Resources absolute_difference(int bits);
// Sums `count` numbers of 0..most in one cycle, in a tree of adders.
Resources adder_tree(int count, std::int64_t most);
// Multiplies two magnitudes. A multiplier of the device takes 17 bits of each. Longer numbers are multiplied
// in parts, and the products of the parts are added.
Resources product(int bits, int other_bits);
// radix * high + low, where low < radix: a multiplier and an adder. A radix that is a power of two takes no
// logic: the bits of `low` follow those of `high`.
Resources digits(int radix, int bits);
// Holds a number until the next clock enable: one flip-flop per bit.
Resources registers(int bits);
// Delays a number by `length` clock enables, or queues up to `length` numbers. A length of 1 takes one
// flip-flop per bit. A longer register takes one SRL16 per bit for every 16 places. The multiplexers of the
// slices (MUXF5 to MUXF8) join the SRL16s of a queue.
Resources shift_register(int length, int bits);
// A memory with a write port and a read port: block RAMs side by side, each 512 x 36, or deeper and narrower
// (1K x 18, 2K x 9, 4K x 4, 8K x 2, 16K x 1) so that no multiplexer is needed.
Resources memory(int words, int bits);

}  // namespace stereotlm::area
