#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace stereotlm::report {

// The lines of a CSV file that `run --record` writes, which quotes nothing.
class CsvLines {
 public:
  using Cells = std::vector<std::string_view>;

  // `head`: the first line, which all others must equal in the number of cells.
  CsvLines(std::string name, const std::string& head);

  // Reads whole lines, those of the head first, and hands out the cells of each. Throws std::runtime_error if
  // they are not those of the file.
  void read(std::string_view text, const std::function<void(const Cells& cells)>& line);
  // The number in a cell. Throws as read() does.
  std::uint64_t number(std::string_view cell) const;

 private:
  void split(std::string_view line);
  [[noreturn]] void fail() const;

  std::string name_;
  std::string head_;
  std::uint64_t line_ = 0;
  std::size_t size_;
  Cells cells_;
};

}  // namespace stereotlm::report
