#pragma once

#include <cstdint>
#include <vector>

#include "models/stream.h"

namespace stereotlm::fpga {

// The end of a stream: keeps what arrives.
template <class Beat>
class Collected : public StreamIf<Beat> {
 public:
  void push(const Beat& beat) override { beats.push_back(beat); }
  std::vector<Beat> beats;
};

// Pixels without pattern, the same in every run.
inline std::vector<std::uint8_t> noise(std::size_t count, std::uint32_t seed) {
  std::vector<std::uint8_t> values(count);
  for (std::uint8_t& value : values) {
    seed = seed * 1664525U + 1013904223U;
    value = static_cast<std::uint8_t>(seed >> 24U);
  }
  return values;
}

}  // namespace stereotlm::fpga
