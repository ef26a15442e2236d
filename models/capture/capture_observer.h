#pragma once

#include <cstddef>
#include <cstdint>

#include "models/capture/capture_register_file.h"

namespace stereotlm::capture {

// Why a capture board does not take a frame of its camera.
enum class DropReason : std::uint8_t { kNotArmed, kBusy, kPartner };

// Receives what a capture board does with the frames of its camera, for recordings. Plain C++.
class CaptureObserver {
 public:
  virtual ~CaptureObserver() = default;
  virtual void frame_begun(std::uint64_t frame, std::uint64_t begin_ps) = 0;
  // One of these follows, 1 ps after the beginning of the frame.
  virtual void frame_dropped(std::uint64_t frame, std::uint64_t begin_ps, DropReason reason) = 0;
  virtual void capture_begun(std::uint64_t frame, std::uint64_t begin_ps) = 0;
  // Called at capture.end_ps. The interrupt has risen.
  virtual void capture_ended(const Capture& capture) = 0;
  // The program has cleared the interrupt.
  virtual void interrupt_cleared(std::uint64_t now_ps) = 0;
};

// Receives the level of a capture board's FIFO, for traces. Plain C++.
class FifoObserver {
 public:
  virtual ~FifoObserver() = default;
  // The FIFO holds this number of complete words. Called as each burst of the board begins, and as it ends.
  virtual void fifo_holds(std::uint64_t now_ps, std::size_t words) = 0;
};

}  // namespace stereotlm::capture
