#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "platform/audit.h"

namespace stereotlm::report {

// Reads the lines of a CSV file that `run --record` has written, which quotes nothing. All functions throw
// std::runtime_error if something is not as `run` writes it: "PATH:LINE: column = value: rule".
class CsvLines {
 public:
  // `head`: the first line, which all others must equal in the number of cells.
  CsvLines(std::string path, const std::string& head);

  // Reads whole lines, those of the head first, and calls `line` for each behind the head.
  void read(std::string_view text, const std::function<void()>& line);
  // To be called at the end of the file, with the identities of the whole file. They name its last line.
  void finish(const platform::Audit& audit) const;

  // Of the line that `line` has been called for. Columns count from 0.
  std::string_view cell(std::size_t column) const { return cells_[column]; }
  // The text of several cells, with the commas between them.
  std::string_view cells(std::size_t first, std::size_t count) const;
  std::uint64_t number(std::size_t column, std::uint64_t most = INT64_MAX, std::uint64_t least = 0) const;
  // The index of the cell among the names.
  std::size_t index(std::size_t column, const std::vector<std::string>& names) const;
  // Throws if `holds` is false.
  void require(bool holds, std::size_t column, const char* rule) const {
    if (!holds) refuse(column, rule);
  }
  [[noreturn]] void refuse(std::size_t column, const std::string& rule) const;

 private:
  void split(std::string_view line);
  [[noreturn]] void fail(const std::string& text) const;

  std::string path_;
  std::string head_;
  std::vector<std::string> names_;  // of the columns
  std::uint64_t line_ = 0;          // number of the line that is read; the first is 1
  std::vector<std::string_view> cells_;
};

}  // namespace stereotlm::report
