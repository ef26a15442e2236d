#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "models/fpga/row_profile.h"

namespace stereotlm::report {

// The rows by themselves: cycles and stalls since the row above was whole; those of the top row since the
// frame began.
fpga::RowProfile rows_alone(const fpga::RowProfile& profile);

// The rows of results of two runs, A and B, frame by frame: what each takes more in B, by itself.
class RowComparison {
 public:
  // The next frame of both. Throws std::invalid_argument if it has not as many rows in both, and as the
  // frames before.
  void add(const fpga::RowProfile& a, const fpga::RowProfile& b);

  std::uint64_t frames() const { return frames_; }

  // The first row that is not whole after as many cycles of its frame.
  struct Parting {
    std::uint64_t frame = 0;
    std::size_t row = 0;
    std::uint64_t cycles_a = 0;
    std::uint64_t cycles_b = 0;
  };
  const std::optional<Parting>& parting() const { return parting_; }

  // The first row with other stalls of its own.
  struct OtherStalls {
    std::uint64_t frame = 0;
    std::size_t row = 0;
  };
  const std::optional<OtherStalls>& other_stalls() const { return other_stalls_; }

  // Rows one below the other, summed over the frames, B - A.
  struct Range {
    std::size_t first_row = 0;
    std::size_t last_row = 0;
    std::int64_t cycles = 0;                                  // of all its rows
    std::int64_t least = 0;                                   // of one row
    std::int64_t most = 0;                                    // of one row
    std::array<std::int64_t, fpga::kCorePortCount> stalls{};  // of all its rows
  };
  // From the top, those whose rows all have the same cycles and stalls more or less; where these are more
  // than `most_ranges`, those whose rows all take as many cycles more or less, or else so many of the same
  // height. Left out are those of rows that take as long in both, without stalls in all that one of them has
  // more: the others sum up to the whole, in cycles and in stalls.
  std::vector<Range> ranges(std::size_t most_ranges) const;

 private:
  struct Row {
    std::int64_t cycles = 0;
    std::array<std::int64_t, fpga::kCorePortCount> stalls{};
  };

  Range range(std::size_t first_row, std::size_t last_row) const;
  // Of rows that `is_same` as the one above.
  template <typename IsSame>
  std::vector<Range> runs_of(const IsSame& is_same) const;

  std::uint64_t frames_ = 0;
  std::vector<Row> rows_;  // sums over the frames, B - A
  std::optional<Parting> parting_;
  std::optional<OtherStalls> other_stalls_;
};

}  // namespace stereotlm::report
