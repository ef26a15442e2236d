#pragma once

#include <cstdint>

// The windows and registers of the PCI bridge on the FPGA board (PLX PCI 9656 class; the register map is our
// own).
//
// The bridge has two windows on the PCI bus. The slave window leads to the local bus:
//
// | offset                       | leads to                                                         |
// |------------------------------|------------------------------------------------------------------|
// | i * kApertureBytes, i = 0..3 | the banks, beginning with the word that page register i names    |
// | kCoreRegisters               | the registers of the FPGA core (fpga/register_map.h)             |
//
// The register window has registers of 32 bits. c is the number of a DMA channel:
//
// | offset      | name             | access | meaning                                                   |
// |-------------|------------------|--------|-----------------------------------------------------------|
// | 0x00 + 4 i  | kPage            | both   | first word of aperture i: bits 31..26 bank, 25..0 word    |
// | 0x10        | kInterruptStatus | both   | kDoorbell, kDmaDone << c, kDmaError << c, kPostedError.   |
// |             |                  |        | Writing a 1 clears a bit                                  |
// | 0x14        | kInterruptEnable | both   | the bits of kInterruptStatus that raise INTA#             |
// | 0x20 + 16 c | kDmaDescriptor   | both   | PCI address of the first descriptor of the channel's      |
// |             |                  |        | chain, a multiple of 16                                   |
// | 0x24 + 16 c | kDmaControl      | write  | 1: start. A start while the channel is busy raises        |
// |             |                  |        | kDmaError                                                 |
// | 0x28 + 16 c | kDmaStatus       | read   | 1: busy                                                   |
// | 0x40 + 4 i  | kNextPage        | write  | first word of the next part of aperture i, as kPage       |
//
// An aperture may lead to a striped picture (contract 8.2): kPage names the first word of part 0, and ends
// the list of parts. Each kNextPage adds a part. Row y of the picture then is row floor(y / N) of part y mod
// N of the N parts. A burst into such an aperture ends with its row.
//
// A descriptor is four words in host memory:
//
// | word | meaning                                                                                   |
// |------|-------------------------------------------------------------------------------------------|
// | 0    | PCI address of the first byte, a multiple of 4                                            |
// | 1    | first word on the board: bits 31..26 bank, 25..0 word                                     |
// | 2    | bit 31: from the board to PCI, else from PCI to the board; bits 30..0: words, at least 1  |
// | 3    | PCI address of the next descriptor, a multiple of 16; 0: this is the last                 |
//
// A channel stops at an error. When it raises kDmaError, its last words may still be under way.
namespace stereotlm::pci::bridge {

inline constexpr int kApertures = 4;                                          // of the slave window
inline constexpr std::uint64_t kApertureBytes = std::uint64_t{1} << 26U;      // holds the largest picture
inline constexpr std::uint64_t kCoreRegisters = kApertures * kApertureBytes;  // behind the apertures
inline constexpr std::uint64_t kSlaveWindowBytes = kCoreRegisters + 4096;     // size of the slave window

inline constexpr int kChannels = 2;                      // DMA channels
inline constexpr std::uint64_t kPage = 0x00;             // of aperture 0; that of aperture i is 4 i bytes on
inline constexpr std::uint64_t kInterruptStatus = 0x10;  // pending interrupts
inline constexpr std::uint64_t kInterruptEnable = 0x14;  // interrupts that raise INTA#
inline constexpr std::uint64_t kDmaDescriptor = 0x20;    // register of channel 0
inline constexpr std::uint64_t kDmaControl = 0x24;       // register of channel 0
inline constexpr std::uint64_t kDmaStatus = 0x28;        // register of channel 0
inline constexpr std::uint64_t kChannelStride = 0x10;    // from a register of channel 0 to that of channel 1
inline constexpr std::uint64_t kNextPage = 0x40;         // of aperture 0; that of aperture i is 4 i bytes on
inline constexpr std::uint64_t kRegisterWindowBytes = 0x50;  // behind the last register

inline constexpr std::uint32_t kDoorbell = 1U << 0U;  // the FPGA's interrupt has risen
inline constexpr std::uint32_t kDmaDone = 1U << 1U;   // for channel 0; the next higher bit is for channel 1
inline constexpr std::uint32_t kDmaError = 1U << 3U;  // for channel 0; the next higher bit is for channel 1
inline constexpr std::uint32_t kPostedError = 1U << 5U;          // the local bus refused a posted write
inline constexpr std::uint32_t kAllInterrupts = (1U << 6U) - 1;  // every bit of kInterruptStatus

inline constexpr std::uint32_t kToPci = 1U << 31U;  // in word 2 of a descriptor: from the board to PCI

// The byte address on the local bus of a word on the board, given by bank and word as in the registers.
constexpr std::uint64_t local_address(std::uint32_t board_word) {
  return static_cast<std::uint64_t>(board_word >> 26U) << 28U | (board_word & 0x03FF'FFFFULL) << 2U;
}

// The size of a bank's address range on the local bus. A burst stays in one bank.
inline constexpr std::uint64_t kBankBytes = std::uint64_t{1} << 28U;

}  // namespace stereotlm::pci::bridge
