#include "models/area/parts.h"

#include <algorithm>
#include <array>

namespace stereotlm::area {
namespace {

struct Shape {
  int words;
  int bits;
};
constexpr std::array<Shape, 6> kBlockRamShapes = {
    {{512, 36}, {1024, 18}, {2048, 9}, {4096, 4}, {8192, 2}, {16384, 1}}};
constexpr int kSrlLength = 16;
constexpr int kMultiplierBits = 17;     // bits of a magnitude that one multiplier takes
constexpr int kMultiplexerInputs = 32;  // inputs of the largest multiplexer in slices, which MUXF8 completes

constexpr std::int64_t ceil_of(std::int64_t part, std::int64_t whole) { return (part + whole - 1) / whole; }

}  // namespace

Resources& Resources::operator+=(const Resources& other) {
  luts += other.luts;
  flip_flops += other.flip_flops;
  block_rams += other.block_rams;
  multipliers += other.multipliers;
  return *this;
}

Resources operator+(Resources one, const Resources& other) { return one += other; }

Resources operator*(std::int64_t count, const Resources& each) {
  return {count * each.luts, count * each.flip_flops, count * each.block_rams, count * each.multipliers};
}

int bits_of(std::int64_t largest) {
  int bits = 0;
  for (; largest > 0; largest /= 2) ++bits;
  return bits;
}

int bits_of(Range range) {
  if (range.low >= 0) return bits_of(range.high);
  if (range.high <= 0) return bits_of(-range.low);
  return 1 + std::max(bits_of(range.high), bits_of(-range.low - 1));
}

Resources adder(int bits) { return {bits}; }

Resources comparator(int bits) { return {bits + 1}; }

Resources selector(int bits) { return {bits}; }

Resources multiplexer(int numbers, int bits) {
  if (numbers == 1) return {};
  const Resources groups{ceil_of(numbers, 2) * bits};
  return groups + multiplexer(static_cast<int>(ceil_of(numbers, kMultiplexerInputs)), bits);
}

Resources equality(int bits) { return {ceil_of(bits, 2)}; }

Resources absolute_difference(int bits) { return comparator(bits) + selector(bits); }

Resources adder_tree(int count, std::int64_t most) {
  if (count == 1) return {};
  const int half = count / 2;
  return adder_tree(half, most) + adder_tree(count - half, most) + adder(bits_of(most * count));
}

Resources product(int bits, int other_bits) {
  const std::int64_t parts = ceil_of(bits, kMultiplierBits) * ceil_of(other_bits, kMultiplierBits);
  return Resources{0, 0, 0, parts} + (parts - 1) * adder(bits + other_bits - kMultiplierBits);
}

Resources digits(int radix, int bits) {
  const bool is_power_of_two = bits_of(radix) != bits_of(radix - 1);
  return is_power_of_two ? Resources{} : Resources{0, 0, 0, 1} + adder(bits);
}

Resources registers(int bits) { return {0, bits}; }

Resources shift_register(int length, int bits) {
  return length == 1 ? registers(bits) : Resources{ceil_of(length, kSrlLength) * bits};
}

Resources memory(int words, int bits) {
  const auto deep_enough = std::find_if(kBlockRamShapes.begin(), kBlockRamShapes.end() - 1,
                                        [words](const Shape& shape) { return words <= shape.words; });
  return {0, 0, ceil_of(words, deep_enough->words) * ceil_of(bits, deep_enough->bits), 0};
}

}  // namespace stereotlm::area
