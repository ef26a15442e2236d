#pragma once

#include <cstdint>

namespace stereotlm::memory {

// A byte address on the crossbar: bits 28 and up are the bank, the lower bits the byte in that bank.
inline constexpr unsigned kBankAddressBits = 28;
constexpr std::uint64_t crossbar_address(std::uint64_t bank, std::uint64_t word) {
  return bank << kBankAddressBits | word << 2U;
}
constexpr std::uint64_t address_in_bank(std::uint64_t address) {
  return address & ((std::uint64_t{1} << kBankAddressBits) - 1);
}
constexpr std::uint64_t bank_of_address(std::uint64_t address) { return address >> kBankAddressBits; }

}  // namespace stereotlm::memory
