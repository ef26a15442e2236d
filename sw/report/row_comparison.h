#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "models/fpga/row_profile.h"

namespace stereotlm::report {

// The cycles and stalls of each row alone: from the completion of the row above, or from the start of the frame,
// to its own completion.
fpga::RowProfile rows_alone(const fpga::RowProfile& profile);

// Compares the rows of results of two runs, A and B: the cycles and stalls that each row alone takes more in B.
class RowComparison {
 public:
  // Adds the next frame of both runs. Throws std::invalid_argument if the numbers of rows differ, or differ from
  // earlier frames.
  void add(const fpga::RowProfile& a, const fpga::RowProfile& b);

  std::uint64_t frames() const { return frames_; }

  // The first row that is complete at different cycles of its frame.
  struct Parting {
    std::uint64_t frame = 0;
    std::size_t row = 0;
    std::uint64_t cycles_a = 0;
    std::uint64_t cycles_b = 0;
  };
  const std::optional<Parting>& parting() const { return parting_; }

  // The first row whose own stalls differ.
  struct OtherStalls {
    std::uint64_t frame = 0;
    std::size_t row = 0;
  };
  const std::optional<OtherStalls>& other_stalls() const { return other_stalls_; }

  // Adjacent rows. Figures are sums over the frames, B - A.
  struct Range {
    std::size_t first_row = 0;
    std::size_t last_row = 0;
    std::int64_t cycles = 0;                                  // sum over the rows
    std::int64_t least = 0;                                   // least cycles of one row
    std::int64_t most = 0;                                    // most cycles of one row
    std::array<std::int64_t, fpga::kCorePortCount> stalls{};  // sums over the rows
  };
  // Ranges of rows from top to bottom, at most `most_ranges`. The rows of a range have the same difference in
  // cycles and stalls; if these are too many ranges, in cycles only; if still too many, ranges have equal
  // heights. A range without any difference in its sums is left out, so that the others sum up to the whole.
  std::vector<Range> ranges(std::size_t most_ranges) const;

 private:
  struct Row {
    std::int64_t cycles = 0;
    std::array<std::int64_t, fpga::kCorePortCount> stalls{};
  };

  Range range(std::size_t first_row, std::size_t last_row) const;
  // Ranges of rows for which `is_same` holds between neighbours.
  template <typename IsSame>
  std::vector<Range> runs_of(const IsSame& is_same) const;

  std::uint64_t frames_ = 0;
  std::vector<Row> rows_;  // sums over the frames, B - A
  std::optional<Parting> parting_;
  std::optional<OtherStalls> other_stalls_;
};

}  // namespace stereotlm::report
