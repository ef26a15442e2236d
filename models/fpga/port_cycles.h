#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>

namespace stereotlm::fpga {

// What a port does in a cycle, decided from the state at its beginning (contract section 2, "Port states").
enum class Intent : std::uint8_t { kRequest, kPass, kIdle, kBlocked, kStarved };

// Counts the cycles of a port by what it did in them. A cycle with a request counts as granted or as stalled.
class PortCycles {
 public:
  void add(Intent intent, bool granted, std::uint64_t cycles = 1) {
    cycles_[kind_of(intent, granted)] += cycles;
  }
  // Adds the cycles of `others`, `times` times.
  void add(const PortCycles& others, std::uint64_t times) {
    for (std::size_t kind = 0; kind < cycles_.size(); ++kind) cycles_[kind] += others.cycles_[kind] * times;
  }
  // The cycles added since the copy `before` was made.
  PortCycles since(const PortCycles& before) const {
    PortCycles since = *this;
    for (std::size_t kind = 0; kind < cycles_.size(); ++kind) since.cycles_[kind] -= before.cycles_[kind];
    return since;
  }

  friend bool operator==(const PortCycles& a, const PortCycles& b) { return a.cycles_ == b.cycles_; }

  std::uint64_t granted() const { return cycles_[kGranted]; }
  std::uint64_t stalled() const { return of(Intent::kRequest); }
  std::uint64_t passed() const { return of(Intent::kPass); }
  std::uint64_t idle() const { return of(Intent::kIdle); }
  std::uint64_t blocked() const { return of(Intent::kBlocked); }
  std::uint64_t starved() const { return of(Intent::kStarved); }
  std::uint64_t sum() const { return std::accumulate(cycles_.begin(), cycles_.end(), std::uint64_t{0}); }

 private:
  static constexpr std::size_t kGranted = 5;
  static constexpr std::size_t kind_of(Intent intent, bool granted) {
    return granted ? kGranted : static_cast<std::size_t>(intent);
  }
  std::uint64_t of(Intent intent) const { return cycles_[static_cast<std::size_t>(intent)]; }

  std::array<std::uint64_t, 6> cycles_{};  // [intent], where kRequest has only stalled cycles; [kGranted]
};

}  // namespace stereotlm::fpga
