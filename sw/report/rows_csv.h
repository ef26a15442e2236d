#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "models/fpga/row_profile.h"
#include "sw/files/replaced_file.h"

namespace stereotlm::report {

// The rows of results of two runs, A and B, as a table for other programs: a line for each frame and row,
// with the row's own cycles and stalls in both. The file is as it was until commit(), and there whole after
// it: a ReplacedFile. All throw std::runtime_error naming the file if it cannot be written.
class RowsCsv {
 public:
  explicit RowsCsv(const std::filesystem::path& path);

  // The next frame of both, with as many rows.
  void add(const fpga::RowProfile& a, const fpga::RowProfile& b);
  void commit();

 private:
  [[noreturn]] void refuse(const std::string& cause) const;

  std::filesystem::path path_;
  std::unique_ptr<files::ReplacedFile> file_;
  std::uint64_t frame_ = 0;
};

}  // namespace stereotlm::report
