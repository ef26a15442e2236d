#include "sw/report/page_data/csv_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <stdexcept>
#include <utility>

namespace stereotlm::report {

CsvLines::CsvLines(std::string name, const std::string& head)
    : name_(std::move(name)),
      head_(head.substr(0, head.find('\n'))),
      size_(1 + static_cast<std::size_t>(std::count(head_.begin(), head_.end(), ','))) {}

void CsvLines::read(std::string_view text, const std::function<void(const Cells& cells)>& line) {
  while (!text.empty()) {
    const std::string_view next = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(text.size(), next.size() + 1));
    if (line_++ == 0) {
      if (next != head_) fail();
      continue;
    }
    split(next);
    if (cells_.size() != size_) fail();
    line(cells_);
  }
}

std::uint64_t CsvLines::number(std::string_view cell) const {
  if (cell == "0") return 0;  // most are
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), number);
  if (error != std::errc() || end != cell.data() + cell.size()) fail();
  return number;
}

void CsvLines::split(std::string_view line) {
  cells_.clear();
  std::size_t begin = 0;
  for (std::size_t end = 0; end < line.size(); ++end) {
    if (line[end] != ',') continue;
    cells_.push_back(line.substr(begin, end - begin));
    begin = end + 1;
  }
  cells_.push_back(line.substr(begin));
}

void CsvLines::fail() const {
  throw std::runtime_error(fmt::format("{}:{}: is not as `run --record` writes it", name_, line_));
}

}  // namespace stereotlm::report
