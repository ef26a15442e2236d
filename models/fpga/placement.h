#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "models/fpga/core_config.h"
#include "models/fpga/core_ports.h"
#include "models/fpga/register_map.h"

namespace stereotlm::fpga {

// Where a buffer lies. Row y of the buffer is row floor(y / N) of part y mod N; a buffer in one bank is its
// only part (contract 8.2).
class Placement {
 public:
  // A 32-bit word of a bank.
  struct Word {
    std::size_t bank;    // its number
    std::uint32_t word;  // number in the bank
  };

  Placement() = default;
  // `stripes`: CoreConfig::stripes. `base`: of the first part, as in the base register. `row_words`: 32-bit
  // words of a row of the buffer.
  Placement(const std::vector<std::vector<std::uint32_t>>& stripes, std::uint32_t base,
            std::uint64_t row_words)
      : parts_({base}), row_words_(row_words) {
    for (const std::vector<std::uint32_t>& stripe : stripes) {
      if (stripe.front() == base) parts_ = stripe;
    }
    is_whole_ = parts_.size() == 1;
    first_address_ = registers::base_address(parts_.front());
  }

  const std::vector<std::uint32_t>& parts() const { return parts_; }  // their bases, part 0 first
  // The number of rows in a part, of a buffer of `height` rows.
  std::uint64_t rows_of_part(std::size_t part, int height) const {
    return (static_cast<std::uint64_t>(height) - part + parts_.size() - 1) / parts_.size();
  }
  // The banks of all parts: bit b for bank b.
  std::uint64_t banks() const {
    std::uint64_t banks = 0;
    for (const std::uint32_t base : parts_) banks |= std::uint64_t{1} << registers::bank_of(base);
    return banks;
  }

  // The word with this number of a row.
  Word word(std::uint64_t row, std::uint64_t number) const {
    const std::uint32_t base = parts_[row % parts_.size()];
    return {registers::bank_of(base),
            registers::first_word_of(base) +
                static_cast<std::uint32_t>(row / parts_.size() * row_words_ + number)};
  }
  // Its byte address on the crossbar.
  std::uint64_t address(std::uint64_t row, std::uint64_t number) const {
    if (is_whole_) return first_address_ + 4 * (row * row_words_ + number);
    return registers::base_address(parts_[row % parts_.size()]) +
           4 * (row / parts_.size() * row_words_ + number);
  }
  std::uint64_t row_words() const { return row_words_; }  // 32-bit words of a row

 private:
  std::vector<std::uint32_t> parts_;  // their bases
  bool is_whole_ = true;              // in one bank
  std::uint64_t row_words_ = 0;
  std::uint64_t first_address_ = 0;
};

// [port group]: where its buffer lies in a frame. Without meaning for a group that does not exist.
using Placements = std::array<Placement, kCoreGroupCount>;
inline Placements placements_of(const CoreConfig& config, const FrameBases& bases) {
  Placements placements;
  for (std::size_t group = 0; group < kCoreGroupCount; ++group) {
    placements[group] =
        Placement(config.stripes, bases[group],
                  static_cast<std::uint64_t>(config.width) * kPortGroups[group].bytes_per_pixel / 4);
  }
  return placements;
}

}  // namespace stereotlm::fpga
