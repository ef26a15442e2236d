#pragma once

#include <cstdint>

// What the parts of a circuit take of a Virtex-II FPGA (Xilinx DS031).
namespace stereotlm::area {

struct Resources {
  std::int64_t luts = 0;        // 4-input look-up tables
  std::int64_t flip_flops = 0;  // each shares a place with the LUT before it, if there is one
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

// The fewest bits that hold 0..largest; none for 0.
int bits_of(std::int64_t largest);
// The same of a range. Of one without positive values the magnitude is held: who uses it subtracts.
int bits_of(Range range);

// One LUT a bit on the carry chain, `bits` of the result; a subtracter takes the same.
Resources adder(int bits);
// Whether one number is less than another: their difference, of which only the borrow is used, at a LUT more.
Resources comparator(int bits);
// One of two numbers: a LUT a bit.
Resources selector(int bits);
// |a - b|: the difference with its borrow, and a LUT a bit that negates it.
Resources absolute_difference(int bits);
// A number held for one clock enable.
Resources registers(int bits);
// A number delayed by `length` clock enables, or a queue of so many places: a flip-flop a bit for a length of
// 1, else SRL16s of up to 16 each; the slices' own multiplexers (MUXF5 to MUXF8) join those of a queue.
Resources shift_register(int length, int bits);
// A memory with one port to write and one to read: block RAMs side by side, each 512 x 36 or as much deeper
// and narrower as needed (1K x 18, 2K x 9, 4K x 4, 8K x 2, 16K x 1), so that nothing has to choose between
// them.
Resources memory(int words, int bits);

}  // namespace stereotlm::area
