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

inline constexpr std::uint64_t kControl = 0x00;          // write: kControlStart, kControlAcknowledge
inline constexpr std::uint64_t kStatus = 0x04;           // read: kStatusBusy, kStatusDone, kStatusError
inline constexpr std::uint64_t kFrameCyclesLow = 0x08;   // read: bits 31..0 of the last frame's cycles
inline constexpr std::uint64_t kFrameCyclesHigh = 0x0c;  // read: bits 63..32
inline constexpr std::uint64_t kLeftImageBase = 0x10;    // base of the left picture
inline constexpr std::uint64_t kRightImageBase = 0x14;   // base of the right picture
inline constexpr std::uint64_t kDisparityBase = 0x18;    // base of the results
inline constexpr std::uint64_t kLeftLutBase = 0x1c;      // base of the left table, or of the joint table
inline constexpr std::uint64_t kRightLutBase = 0x20;     // base of the right table
inline constexpr std::uint64_t kLeftColumns = 0x24;      // offset of the left side's displacements, in pixels
inline constexpr std::uint64_t kLeftRows = 0x28;         // offset of the left side's displacements, in pixels
inline constexpr std::uint64_t kRightColumns = 0x2c;  // offset of the right side's displacements, in pixels
inline constexpr std::uint64_t kRightRows = 0x30;     // offset of the right side's displacements, in pixels
inline constexpr std::uint64_t kEnd = 0x34;           // behind the last register

inline constexpr std::uint32_t kControlStart = 1U << 0U;        // starts a frame
inline constexpr std::uint32_t kControlAcknowledge = 1U << 1U;  // clears done and error
inline constexpr std::uint32_t kStatusBusy = 1U << 0U;          // a frame is under way
inline constexpr std::uint32_t kStatusDone = 1U << 1U;          // a frame has ended; the interrupt
inline constexpr std::uint32_t kStatusError = 1U << 2U;  // a strobe ignored, an access refused, or a hazard

// A value to be written to a register.
struct RegisterValue {
  std::uint64_t address;  // byte address
  std::uint32_t value;    // 32 bits
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
// Bank and word in the value of a base register.
constexpr std::uint32_t bank_of(std::uint32_t base) { return base >> 26U; }
constexpr std::uint32_t first_word_of(std::uint32_t base) { return base & 0x03FF'FFFFU; }
// The byte address on the crossbar that the value stands for.
constexpr std::uint64_t base_address(std::uint32_t value) {
  return static_cast<std::uint64_t>(value >> 26U) << 28U | (value & 0x03FF'FFFFULL) << 2U;
}

}  // namespace stereotlm::fpga::registers
