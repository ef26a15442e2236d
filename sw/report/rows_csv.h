#pragma once

#include <cstdint>
#include <filesystem>

#include "models/fpga/row_profile.h"
#include "sw/files/output_file.h"

namespace stereotlm::report {

// Writes a CSV file with the rows of results of two runs, A and B: one line per frame and row with the row's
// own cycles and stalls in both runs. See files::OutputFile for commit() and errors.
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

}  // namespace stereotlm::report
