#pragma once

#include <cstdint>
#include <optional>

namespace stereotlm::capture {

// A capture, from the frame that it takes to its last word.
struct Capture {
  std::uint64_t frame = 0;  // number of the camera frame
  std::uint64_t begin_ps = 0;
  std::uint64_t end_ps = 0;
  std::uint64_t dropped_pixels = 0;
  std::uint64_t lost_words = 0;
  std::uint64_t words = 0;  // words written
};

// The registers of a capture board (capture_registers.h): the armed capture, the status and the level of the
// interrupt. Plain C++.
class CaptureRegisterFile {
 public:
  // Whether the register has this direction. `address`: a multiple of 4 below registers::kEnd.
  static bool allows(bool write, std::uint64_t address);
  // `address`: of a register that can be read.
  std::uint32_t read(std::uint64_t address) const;
  // `address`: of a register that can be written. Returns whether the write triggers the cameras.
  bool write(std::uint64_t time_ps, std::uint64_t address, std::uint32_t value);

  // Whether a capture is armed, and was armed at `time_ps` already.
  bool armed_at(std::uint64_t time_ps) const { return armed_ && armed_ps_ <= time_ps; }
  bool capturing() const { return capturing_; }
  // Starts the armed capture, and returns its buffer address.
  std::uint32_t start();
  // To be called when words of the running capture are lost, because the bus did not take them.
  void lose_words() { words_lost_ = true; }
  // Ends the running capture.
  void finish(const Capture& capture);
  // The last capture that has ended; none before the first one ends.
  const std::optional<Capture>& last_capture() const { return last_capture_; }

  bool interrupt() const { return done_ || words_lost_; }

 private:
  void arm(std::uint64_t time_ps);
  void clear(std::uint32_t status_bits);

  std::uint32_t buffer_address_ = 0;
  bool armed_ = false;
  std::uint64_t armed_ps_ = 0;
  std::uint32_t armed_address_ = 0;
  bool capturing_ = false;
  bool done_ = false;
  bool words_lost_ = false;
  bool arm_refused_ = false;
  std::optional<Capture> last_capture_;
};

}  // namespace stereotlm::capture
