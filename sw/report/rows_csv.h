#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "models/fpga/row_profile.h"
#include "sw/files/replaced_file.h"

namespace stereotlm::report {

// Writes a CSV file with the rows of results of two runs, A and B: one line per frame and row with the row's
// own cycles and stalls in both runs. commit() replaces the file as a whole (files::ReplacedFile). All
// functions throw std::runtime_error with the file's name if it cannot be written.
class RowsCsv {
 public:
  explicit RowsCsv(const std::filesystem::path& path);

  // Adds the next frame of both runs. `a` and `b` have the same number of rows.
  void add(const fpga::RowProfile& a, const fpga::RowProfile& b);
  void commit();

 private:
  [[noreturn]] void refuse(const std::string& cause) const;

  std::filesystem::path path_;
  std::unique_ptr<files::ReplacedFile> file_;
  std::uint64_t frame_ = 0;
};

}  // namespace stereotlm::report
