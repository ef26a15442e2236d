#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "models/fpga/record/row_recorder.h"
#include "models/kernels/gray_image.h"
#include "sw/files/output_file.h"

// The comparison of two runs, A and B, frame by frame.
namespace stereotlm::stats {

// Compares the disparities of two runs, A and B, pixel by pixel.
class PixelComparison {
 public:
  // Adds the disparities of one camera frame. Throws std::invalid_argument if the sizes differ.
  void add(std::uint64_t camera_frame, const kernels::GrayImage& a, const kernels::GrayImage& b);

  std::uint64_t frames() const { return frames_; }  // frames compared
  std::uint64_t frames_that_differ() const { return frames_that_differ_; }
  std::uint64_t pixels() const { return pixels_; }  // pixels that differ, over all frames

  // The first pixel that differs: the leftmost in the topmost row of the first frame with differences.
  struct First {
    std::uint64_t camera_frame = 0;
    int column = 0;
    int row = 0;
    int a = 0;
    int b = 0;
  };
  const std::optional<First>& first() const { return first_; }

 private:
  std::uint64_t frames_ = 0;
  std::uint64_t frames_that_differ_ = 0;
  std::uint64_t pixels_ = 0;
  std::optional<First> first_;
};

// The cycles and stalls of each row alone: from the completion of the row above, or from the start of the
// frame, to its own completion.
fpga::RowProfile rows_alone(const fpga::RowProfile& profile);

// Compares the rows of two runs: how many more cycles and stalls each row alone takes in B than in A.
class RowComparison {
 public:
  // Adds the next frame of both runs. Throws std::invalid_argument if the numbers of rows differ, or differ
  // from earlier frames.
  void add(const fpga::RowProfile& a, const fpga::RowProfile& b);

  std::uint64_t frames() const { return frames_; }

  // The first row that the two runs complete in different cycles of the frame, and these cycles.
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

  // A range of adjacent rows. Figures are sums over the frames, B - A.
  struct Range {
    std::size_t first_row = 0;
    std::size_t last_row = 0;
    std::int64_t cycles = 0;                                   // sum over the rows
    std::int64_t least = 0;                                    // the least cycles of a single row
    std::int64_t most = 0;                                     // the most cycles of a single row
    std::array<std::int64_t, fpga::kCoreGroupCount> stalls{};  // [port group]: sums over the rows and lanes
  };
  // Ranges of rows from top to bottom, at most `most_ranges`. The rows of a range have the same B - A in
  // cycles and in stalls; if that gives too many ranges, only in cycles. If there are still too many, all
  // ranges have the same height, +-1 row. A range is left out if B - A is 0 for the cycles of each row and
  // for each sum of stalls. The others add up to the whole difference.
  std::vector<Range> ranges(std::size_t most_ranges) const;

 private:
  struct Row {
    std::int64_t cycles = 0;
    std::array<std::int64_t, fpga::kCoreGroupCount> stalls{};
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

// Writes a CSV file with the rows of results of two runs, A and B: one line per frame and row with the row's
// own cycles and stalls (of all lanes of a port group) in both runs. See files::OutputFile for commit() and
// errors.
class RowsCsv {
 public:
  explicit RowsCsv(const std::filesystem::path& path);

  // Adds the next frame of both runs. `a` and `b` have the same number of rows.
  void add(const fpga::RowProfile& a, const fpga::RowProfile& b);
  void commit() { file_.commit(); }

 private:
  files::OutputFile file_;
  std::uint64_t frame_ = 0;
};

}  // namespace stereotlm::stats
