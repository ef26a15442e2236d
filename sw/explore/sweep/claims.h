#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "sw/explore/sweep/sweep.h"
#include "sw/process/shared_memory.h"

namespace stereotlm::explore {

// The way in which a point has ended: an index in kCounts.
enum class PointEnd : std::uint8_t { kExcluded = 1, kKnown, kOk, kImpossible, kFailed, kGivenUp };

// The points that the workers of a sweep have begun and ended, in memory that all its processes share. A
// point is a number from 0. Each worker has a place; when it dies, its successor takes the place over. One
// store to memory begins a point, and one store ends it: a place is thus valid at whatever moment its worker
// dies.
class Claims {
 public:
  Claims(std::size_t places, std::uint64_t points);  // throws std::system_error

  // Begins a point: the one that the place has begun and not ended, else the first that no place has begun.
  // Returns nullopt if all have been begun, and after stop().
  std::optional<std::uint64_t> begin(std::size_t place);
  // Ends the point that the place has begun.
  void end(std::size_t place, PointEnd end) { ++places_[place].ended[static_cast<std::size_t>(end)]; }
  // The point that the place has begun and not ended.
  std::optional<std::uint64_t> unfinished(std::size_t place) const;

  // Keeps every process from beginning another point.
  void stop() { *stopped_ = true; }
  bool is_stopped() const { return *stopped_; }

  // How all points have ended that have. `total` is the number of points.
  SweepCounts counts() const;

 private:
  // A cache line for each place, because each is written by another processor.
  struct alignas(64) Place {
    std::atomic<std::uint64_t> last;                               // the point that was begun last
    std::atomic<std::uint64_t> begun;                              // number of points
    std::array<std::atomic<std::uint64_t>, kCounts.size()> ended;  // [PointEnd]: number of points
  };

  std::uint64_t points_;
  std::size_t size_;
  process::SharedMemory memory_;  // a cache line for stopped_, then the places
  std::atomic<bool>* stopped_;
  Place* places_;             // [size_]
  process::SharedLock lock_;  // of begin()
};

}  // namespace stereotlm::explore
