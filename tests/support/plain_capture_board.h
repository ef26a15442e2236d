#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <utility>
#include <vector>

#include "tests/support/plain_clock.h"
#include "tests/support/plain_events.h"
#include "tests/support/plain_pci_bus.h"
#include "tests/support/plain_trace.h"

// A camera's capture board of contract section 3, one pixel at a time.
namespace stereotlm::test {

struct PlainCaptureConfig {
  PlainCamera camera;
  int fifo_words = 0;
  int fifo_trigger_words = 0;
};

// The destination of a picture.
struct PlainPicturePlace {
  PlainTarget* target = nullptr;
  int wait_clocks = 0;
  std::uint64_t word = 0;
  bool striped = false;  // a burst ends with its line
};

class PlainCaptureBoard : private PlainMaster {
 public:
  enum class Readiness { kReady, kNotArmed, kBusy };
  struct Stats {
    std::uint64_t captured_frames = 0;
    std::uint64_t dropped_not_armed = 0;
    std::uint64_t dropped_busy = 0;
    std::uint64_t dropped_by_partner = 0;
    std::uint64_t dropped_pixels = 0;
    std::uint64_t lost_words = 0;
  };

  PlainCaptureBoard(PlainEvents& events, PlainBus& bus, const PlainCaptureConfig& config)
      : events_(events), bus_(bus), config_(config), master_(bus.add(*this)) {}

  void arm(const PlainPicturePlace& place);
  bool done() const { return done_; }
  void clear_done() { done_ = false; }
  std::uint64_t frame_number() const { return done_frame_; }
  PlainTime done_ps() const { return done_ps_; }

  // A camera frame begins now. `partner_is_ready`: the other side can capture it.
  Readiness readiness() const;
  void frame_begins(std::uint64_t number, bool partner_is_ready, const std::vector<std::uint8_t>& pixels);
  // Counts a frame that begins as the run ends.
  void drop_frame() { ++stats_.dropped_not_armed; }

  const Stats& stats() const { return stats_; }
  // The complete words as each comes and leaves.
  const std::vector<PlainLevel>& levels() const { return levels_; }

 private:
  struct Word {
    std::uint64_t place = 0;  // in the picture
    std::uint32_t value = 0;
    int pixels = 0;
    int row = 0;
  };

  PlainBurst burst() override;
  void word_gone() override;
  void lost() override;
  void ended(const PlainWords& words) override;

  void await_pixel();
  void pixel_arrives();
  bool all_pixels_have_come() const { return row_ == config_.camera.height; }
  std::size_t complete_words() const;
  void note_level();
  void request_or_finish();

  PlainEvents& events_;
  PlainBus& bus_;
  PlainCaptureConfig config_;
  std::size_t master_;

  bool armed_ = false;
  PlainPicturePlace next_place_;
  bool done_ = false;
  std::uint64_t done_frame_ = 0;
  PlainTime done_ps_ = 0;

  bool capturing_ = false;
  std::uint64_t frame_ = 0;
  PlainTime begin_ps_ = 0;
  PlainPicturePlace place_;
  std::vector<std::uint8_t> pixels_;
  int column_ = 0;  // of the next pixel
  int row_ = 0;
  bool drops_line_ = false;
  std::deque<Word> fifo_;
  std::size_t owed_ = 0;  // words of the FIFO that were complete at the last grant
  bool asks_ = false;
  bool has_bus_ = false;
  std::size_t burst_words_ = 0;  // of the burst that has the bus
  Stats stats_;
  std::vector<PlainLevel> levels_;
};

// The registers of a capture board on the PCI bus, in words.
enum class PlainCaptureRegister : std::uint64_t { kControl, kStatus, kBuffer, kFrameLow, kFrameHigh };
inline constexpr std::uint32_t kPlainArm = 1;
inline constexpr std::uint32_t kPlainTrigger = 2;
inline constexpr std::uint32_t kPlainDone = 4;

class PlainCaptureRegisters : public PlainTarget {
 public:
  // `place_of` decodes a buffer address; `trigger` begins a frame of the cameras.
  PlainCaptureRegisters(PlainCaptureBoard& board, std::function<PlainPicturePlace(std::uint32_t)> place_of,
                        std::function<void()> trigger)
      : board_(board), place_of_(std::move(place_of)), trigger_(std::move(trigger)) {}
  void write(std::uint64_t word, const PlainWords& words) override;
  void read(std::uint64_t word, std::size_t count, PlainTime end_ps,
            std::function<void(PlainWords)> answer) override;

 private:
  PlainCaptureBoard& board_;
  std::function<PlainPicturePlace(std::uint32_t)> place_of_;
  std::function<void()> trigger_;
  std::uint32_t buffer_ = 0;
};

}  // namespace stereotlm::test
