#pragma once

#include <cstdint>

// The registers of a capture board, 32 bit each, at byte addresses on its `registers` socket. The map is
// ours: the Bt848's own map is that of a video decoder with a DMA program in memory.
//
// | address | name             | access | meaning                                                           |
// |---------|------------------|--------|-------------------------------------------------------------------|
// | 0x00    | kControl         | write  | bit 0: arm a capture; bit 1: trigger the cameras (on demand)      |
// | 0x04    | kStatus          | both   | bit 0: armed; 1: capturing; 2: done; 3: words lost; 4: arming     |
// |         |                  |        | refused. Bits 2 to 4 stay until a 1 is written to them            |
// | 0x08    | kBufferAddress   | both   | bus address of the next capture's buffer, a multiple of 4         |
// | 0x0c    | kFrameNumberLow  | read   | camera frame of the last capture that is done, bits 31..0         |
// | 0x10    | kFrameNumberHigh | read   | bits 63..32                                                       |
// | 0x14    | kDroppedPixels   | read   | pixels of that capture that a full FIFO dropped                   |
// | 0x18    | kLostWords       | read   | words of that capture that the bus did not take: no target        |
// |         |                  |        | responded, or one responded with an error                         |
//
// Arming copies the buffer address. The capture starts at the next beginning of a frame at which both boards
// of a pair are armed and neither has a capture running. A board that is armed at that very time takes part.
// The capture is done when the last word of the frame has been written, dropped or lost. The next capture
// may be armed meanwhile. Arming is refused while a capture is armed, or if the address is not a multiple of
// 4. One write may both arm and trigger. The interrupt is asserted while `done` or `words lost` is set. A
// capture that runs or is armed cannot be cancelled.
namespace stereotlm::capture::registers {

inline constexpr std::uint64_t kControl = 0x00;          // write: kControlArm, kControlTrigger
inline constexpr std::uint64_t kStatus = 0x04;           // kStatusArmed and the others
inline constexpr std::uint64_t kBufferAddress = 0x08;    // bus address of the next capture's buffer
inline constexpr std::uint64_t kFrameNumberLow = 0x0c;   // bits 31..0 of the last capture's frame number
inline constexpr std::uint64_t kFrameNumberHigh = 0x10;  // bits 63..32
inline constexpr std::uint64_t kDroppedPixels = 0x14;    // pixels of the last capture that the FIFO dropped
inline constexpr std::uint64_t kLostWords = 0x18;        // words of the last capture that were lost
inline constexpr std::uint64_t kEnd = 0x1c;              // behind the last register

inline constexpr std::uint32_t kControlArm = 1U << 0U;        // arms a capture
inline constexpr std::uint32_t kControlTrigger = 1U << 1U;    // triggers the cameras on demand
inline constexpr std::uint32_t kStatusArmed = 1U << 0U;       // a capture is armed
inline constexpr std::uint32_t kStatusCapturing = 1U << 1U;   // a capture is under way
inline constexpr std::uint32_t kStatusDone = 1U << 2U;        // a capture has ended; cleared by writing 1
inline constexpr std::uint32_t kStatusWordsLost = 1U << 3U;   // words were lost; cleared by writing 1
inline constexpr std::uint32_t kStatusArmRefused = 1U << 4U;  // an arming was refused; cleared by writing 1

}  // namespace stereotlm::capture::registers
