#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>

#include "models/fpga/row_profile.h"

namespace stereotlm::report {

// The rows of results of two runs, A and B, as a table for other programs: a line for each frame and row, with the
// row's own cycles and stalls in both. The file is as it was until commit(), and there whole after it; it is written
// aside (F.part).
class RowsCsv {
 public:
  // Throws std::runtime_error naming the file if it cannot be written.
  explicit RowsCsv(const std::filesystem::path& path);
  // Without commit(): removes what was written aside.
  ~RowsCsv();
  RowsCsv(const RowsCsv&) = delete;
  RowsCsv& operator=(const RowsCsv&) = delete;

  // The next frame of both, with as many rows.
  void add(const fpga::RowProfile& a, const fpga::RowProfile& b);
  // Throws std::runtime_error if not all could be stored.
  void commit();

 private:
  std::filesystem::path path_;
  std::filesystem::path aside_;
  std::ofstream file_;
  std::uint64_t frame_ = 0;
};

}  // namespace stereotlm::report
