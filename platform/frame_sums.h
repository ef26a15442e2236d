#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "models/fpga/frame_counts.h"
#include "models/memory/arbitration.h"
#include "platform/collect.h"

namespace stereotlm::platform {

// What the stages would have counted in frames whose data they did not move, summed over the frames.
class FrameSums {
 public:
  explicit FrameSums(std::size_t banks) : accesses_(banks) {}

  // `arbitration` still has the routes of the frame.
  void add(const fpga::FrameCounts& frame, const memory::Arbitration& arbitration) {
    for (std::size_t port = 0; port < fpga::kCorePortCount; ++port)
      accesses_[arbitration.bank_of(port)] += frame.accesses[port];
    for (std::size_t side = 0; side < issued_.size(); ++side) issued_[side] += frame.lanes[side].slots.slots;
    packed_words_ += frame.packed.words;
    written_words_ += frame.result.writes;
  }
  // Adds accesses that belong to no frame.
  void add_accesses(std::size_t bank, std::uint64_t accesses) { accesses_[bank] += accesses; }

  void put_into(BoardCounters& counters) const {
    for (std::size_t bank = 0; bank < accesses_.size(); ++bank)
      counters.banks[bank].accesses = accesses_[bank];
    counters.left.issued = issued_[0];
    counters.right.issued = issued_[1];
    counters.packed_words = packed_words_;
    counters.written_words = written_words_;
  }

 private:
  std::vector<std::uint64_t> accesses_;    // [bank]
  std::array<std::uint64_t, 2> issued_{};  // [side]: slots
  std::uint64_t packed_words_ = 0;
  std::uint64_t written_words_ = 0;
};

}  // namespace stereotlm::platform
