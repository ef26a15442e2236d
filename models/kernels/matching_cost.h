#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "models/kernels/integer_rule.h"

namespace stereotlm::kernels {

// How the matcher compares two windows of n x n pixels (contract 1.3 and 7.6).
enum class CostKind : std::uint8_t {
  kSad,     // sum of the absolute differences; the smallest wins
  kSsd,     // sum of the squared differences; the smallest wins
  kZncc,    // zero-mean normalised cross-correlation; the greatest wins
  kCensus,  // sum of the Hamming distances of the pixels' census bits; the smallest wins
};

inline constexpr IntegerRule kCensusSizeRule{3, 7, 2};  // rows, and columns
inline constexpr int kMostPixelBytes = 6;               // 7 * 7 - 1 bits

// A kind of cost with its parameter.
struct MatchingCost {
  CostKind kind = CostKind::kSad;  // measure of difference that is summed
  int census_size = 0;  // c: rows and columns of the neighbourhood, kCensusSizeRule; 0 unless kCensus

  // The rows and columns beyond the window that the cost reads on each side, in pixels.
  int half() const { return kind == CostKind::kCensus ? (census_size - 1) / 2 : 0; }
  // The census bits of a pixel, one for each neighbour; only with kCensus.
  int census_bits() const { return census_size * census_size - 1; }
  // The bytes of a pixel that is compared: a grey level, or census bits.
  int pixel_bytes() const { return kind == CostKind::kCensus ? census_bits() / 8 : 1; }

  friend bool operator==(const MatchingCost& a, const MatchingCost& b) {
    return a.kind == b.kind && a.census_size == b.census_size;
  }
  friend bool operator!=(const MatchingCost& a, const MatchingCost& b) { return !(a == b); }
};

// The name of a kind in board files: "sad".
const char* name_of(CostKind kind);

// Every broken rule as `field = value: rule`; empty if the cost can be computed.
std::vector<std::string> problems(const MatchingCost& cost);

}  // namespace stereotlm::kernels
