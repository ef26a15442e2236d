#include "calib/source_lines.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>

namespace stereotlm::calib {
namespace {

// Rows of the source picture, both ends included; none if last < first.
struct SourceRows {
  int first = std::numeric_limits<int>::max();
  int last = -1;

  void include(const SourceRows& other) {
    first = std::min(first, other.first);
    last = std::max(last, other.last);
  }
  int count() const { return last < first ? 0 : last - first + 1; }
};

// The source rows of each row of the rectified picture.
std::vector<SourceRows> rows_of(const kernels::RectificationTable& table) {
  std::vector<SourceRows> rows(static_cast<std::size_t>(table.height));
  auto entry = table.entries.begin();
  for (SourceRows& row : rows) {
    for (const auto end = entry + table.width; entry != end; ++entry) {
      if (kernels::entry_is_valid(*entry)) {
        row.include({kernels::entry_row(*entry), kernels::entry_row(*entry)});
      }
    }
  }
  return rows;
}

}  // namespace

std::vector<int> source_lines(const kernels::RectificationTable& table, int lines) {
  if (const auto found = problems(table); !found.empty()) throw std::invalid_argument(found.front());
  if (lines < 1 || lines > table.height) {
    throw std::invalid_argument("lines = " + std::to_string(lines) + ": must be 1.." +
                                std::to_string(table.height) + ", the height of the table");
  }
  const std::vector<SourceRows> rows = rows_of(table);
  std::vector<int> counts;
  for (auto top = rows.begin(); top + lines <= rows.end(); ++top) {
    SourceRows strip;
    std::for_each(top, top + lines, [&strip](const SourceRows& row) { strip.include(row); });
    counts.push_back(strip.count());
  }
  return counts;
}

}  // namespace stereotlm::calib
