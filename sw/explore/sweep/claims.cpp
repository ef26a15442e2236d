#include "sw/explore/sweep/claims.h"

#include <memory>
#include <new>

namespace stereotlm::explore {

Claims::Claims(std::size_t places, std::uint64_t points)
    : points_(points),
      size_(places),
      memory_((1 + places) * sizeof(Place)),
      stopped_(new (memory_.data()) std::atomic<bool>(false)),
      places_(static_cast<Place*>(memory_.data()) + 1) {
  std::uninitialized_value_construct_n(places_, places);
}

std::optional<std::uint64_t> Claims::begin(std::size_t place) {
  if (is_stopped()) return std::nullopt;
  if (const auto left = unfinished(place)) return left;
  const process::SharedLock::Turn turn(lock_);
  std::uint64_t next = 0;  // all points before it have been begun
  for (std::size_t i = 0; i < size_; ++i) next += places_[i].begun;
  if (next == points_) return std::nullopt;
  places_[place].last = next;
  ++places_[place].begun;
  return next;
}

std::optional<std::uint64_t> Claims::unfinished(std::size_t place) const {
  std::uint64_t ended = 0;
  for (const auto& number : places_[place].ended) ended += number;
  if (ended == places_[place].begun) return std::nullopt;
  return places_[place].last;
}

SweepCounts Claims::counts() const {
  SweepCounts counts;
  counts.total = points_;
  for (std::size_t place = 0; place < size_; ++place) {
    for (std::size_t end = 1; end < kCounts.size(); ++end)
      counts.*kCounts[end].second += places_[place].ended[end];
  }
  return counts;
}

}  // namespace stereotlm::explore
