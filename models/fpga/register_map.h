#pragma once

#include <array>
#include <cstdint>

#include "models/kernels/joint_table.h"

// The registers of the FPGA core, 32 bit each, at byte addresses on its `registers` socket. The paper does
// not print its map; this one is ours.
//
// | address | name             | access | meaning                                                      |
// |---------|------------------|--------|--------------------------------------------------------------|
// | 0x00    | kControl         | write  | bit 0: start strobe; bit 1: acknowledge, clears done, error  |
// | 0x04    | kStatus          | read   | bit 0: busy; bit 1: done, the interrupt; bit 2: error        |
// | 0x08    | kFrameCyclesLow  | read   | frame_cycles of the last finished frame, bits 31..0          |
// | 0x0c    | kFrameCyclesHigh | read   | bits 63..32                                                  |
// | 0x10    | kLeftImageBase   | both   | where the next frame's buffers lie: bits 31..26 bank, 25..0  |
// |         |                  |        | first word                                                   |
// | 0x14    | kRightImageBase  | both   | as kLeftImageBase                                            |
// | 0x18    | kDisparityBase   | both   | as kLeftImageBase                                            |
// | 0x1c    | kLeftLutBase     | both   | as kLeftImageBase                                            |
// | 0x20    | kRightLutBase    | both   | as kLeftImageBase                                            |
// | 0x24    | kLeftColumns     | both   | the offsets of joint tables (contract 7.3), two's complement |
// | 0x28    | kLeftRows        | both   | as kLeftColumns                                              |
// | 0x2c    | kRightColumns    | both   | as kLeftColumns                                              |
// | 0x30    | kRightRows       | both   | as kLeftColumns                                              |
//
// The base of a striped buffer (contract 8.2) is that of its first part. The core knows the places of the
// others (CoreConfig::stripes).
//
// The core takes bases and offsets at the start strobe. It ignores a strobe while it is busy, and a strobe
// with a base in a bank that the board does not have. Both raise error. Error is also raised if memory
// refuses an access of the running frame, or if the frame works directly on memory and its result may differ
// from the result at Fidelity::kCycle. Error stays until it is acknowledged. One write may acknowledge and
// start the next frame.
namespace stereotlm::fpga::registers {

inline constexpr std::uint64_t kControl = 0x00;
inline constexpr std::uint64_t kStatus = 0x04;
inline constexpr std::uint64_t kFrameCyclesLow = 0x08;
inline constexpr std::uint64_t kFrameCyclesHigh = 0x0c;
inline constexpr std::uint64_t kLeftImageBase = 0x10;
inline constexpr std::uint64_t kRightImageBase = 0x14;
inline constexpr std::uint64_t kDisparityBase = 0x18;
inline constexpr std::uint64_t kLeftLutBase = 0x1c;
inline constexpr std::uint64_t kRightLutBase = 0x20;
inline constexpr std::uint64_t kLeftColumns = 0x24;
inline constexpr std::uint64_t kLeftRows = 0x28;
inline constexpr std::uint64_t kRightColumns = 0x2c;
inline constexpr std::uint64_t kRightRows = 0x30;
inline constexpr std::uint64_t kEnd = 0x34;

inline constexpr std::uint32_t kControlStart = 1U << 0U;
inline constexpr std::uint32_t kControlAcknowledge = 1U << 1U;
inline constexpr std::uint32_t kStatusBusy = 1U << 0U;
inline constexpr std::uint32_t kStatusDone = 1U << 1U;
inline constexpr std::uint32_t kStatusError = 1U << 2U;

struct RegisterValue {
  std::uint64_t address;
  std::uint32_t value;
};
// The values of the registers for the offsets of joint tables.
constexpr std::array<RegisterValue, 4> joint_offsets(const kernels::JointOffsets& offsets) {
  return {{{kLeftColumns, static_cast<std::uint32_t>(offsets[0].columns)},
           {kLeftRows, static_cast<std::uint32_t>(offsets[0].rows)},
           {kRightColumns, static_cast<std::uint32_t>(offsets[1].columns)},
           {kRightRows, static_cast<std::uint32_t>(offsets[1].rows)}}};
}

// The value of a base register, and the bank and the word in it.
constexpr std::uint32_t base(std::uint32_t bank, std::uint32_t first_word) {
  return bank << 26U | first_word;
}
constexpr std::uint32_t bank_of(std::uint32_t base) { return base >> 26U; }
constexpr std::uint32_t first_word_of(std::uint32_t base) { return base & 0x03FF'FFFFU; }
// The byte address on the crossbar that the value stands for.
constexpr std::uint64_t base_address(std::uint32_t value) {
  return static_cast<std::uint64_t>(value >> 26U) << 28U | (value & 0x03FF'FFFFULL) << 2U;
}

}  // namespace stereotlm::fpga::registers
