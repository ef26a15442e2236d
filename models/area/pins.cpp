#include "models/area/pins.h"

#include <algorithm>
#include <cstdint>

#include "models/area/parts.h"

namespace stereotlm::area {

BankPins pins_of(const memory::SsramBankConfig& bank) {
  const auto bits_for = [](std::int64_t places) { return bits_of(places - 1); };
  BankPins pins;
  if (!bank.sdram) {
    pins.address = bits_for(bank.words);
    return pins;
  }
  const std::int64_t row_words = bank.sdram->row_words;
  const std::int64_t banks = bank.sdram->internal_banks;
  pins.address =
      std::max(bits_for(ceil_of(bank.words, row_words * banks)), bits_for(row_words) + 1) + bits_for(banks);
  return pins;
}

}  // namespace stereotlm::area
