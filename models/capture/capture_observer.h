#pragma once

#include <cstddef>
#include <cstdint>

namespace stereotlm::capture {

// A capture, from the frame that it takes to its last word.
struct Capture {
  std::uint64_t frame = 0;           // number of the camera frame
  std::uint64_t begin_ps = 0;        // when the frame began
  std::uint64_t end_ps = 0;          // when the capture ended
  std::uint64_t dropped_pixels = 0;  // pixels that found the FIFO full
  std::uint64_t lost_words = 0;      // words that the bus did not take
  std::uint64_t words = 0;           // words written
};

// Why a capture board does not take a frame of its camera.
enum class DropReason : std::uint8_t { kNotArmed, kBusy, kPartner };

// Receives what a capture board does with the frames of its camera, for recordings. Plain C++.
class CaptureObserver {
 public:
  virtual ~CaptureObserver() = default;
  virtual void frame_begun(std::uint64_t frame, std::uint64_t begin_ps) = 0;  // a frame of the camera begins
  // One of these follows, 1 ps after the beginning of the frame.
  virtual void frame_dropped(std::uint64_t frame, std::uint64_t begin_ps, DropReason reason) = 0;
  virtual void capture_begun(std::uint64_t frame, std::uint64_t begin_ps) = 0;
  // Called at capture.end_ps. The interrupt has risen.
  virtual void capture_ended(const Capture& capture) = 0;
  // The program has cleared the interrupt.
  virtual void interrupt_cleared(std::uint64_t now_ps) = 0;
};

// Receives the words of a capture board's FIFO, for traces. Words that come are reported in the order of
// their times, and so are words that leave. A report may be late, and may be repeated. Plain C++.
class FifoObserver {
 public:
  virtual ~FifoObserver() = default;
  // The last pixel of a word has arrived.
  virtual void word_came(std::uint64_t time_ps) = 0;
  // All words that leave at this time: the end of their data clock, or of a burst that loses them.
  virtual void words_left(std::uint64_t time_ps, std::size_t words) = 0;
};

}  // namespace stereotlm::capture
