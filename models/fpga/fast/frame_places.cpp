#include "models/fpga/fast/frame_places.h"

#include <algorithm>
#include <map>

#include "models/fpga/core_ports.h"
#include "models/fpga/frame_geometry.h"
#include "models/kernels/words.h"

namespace stereotlm::fpga {
namespace {

using Key = std::vector<std::uint64_t>;

// Gives equal keys the same number.
class Numbers {
 public:
  std::uint64_t of(const Key& key) { return numbers_.try_emplace(key, numbers_.size()).first->second; }

 private:
  std::map<Key, std::uint64_t> numbers_;
};

// What the ports access with each column, as keys.
class Accesses {
 public:
  Accesses(const CoreConfig& config, const Placements& placements, const std::vector<SdramPart>& sdram)
      : config_(config), geometry_(config), placements_(placements), sdram_(sdram) {}

  // The columns at which the accesses may change, sorted.
  std::vector<std::uint64_t> changes() const {
    std::vector<std::uint64_t> columns = {geometry_.columns, fewer_rows_column()};
    for (std::uint64_t first = 0; first < geometry_.columns; first += width()) {
      columns.push_back(first);
      for (std::size_t group = 0; group < kResultGroup; ++group) add_row_ends(group, first, columns);
    }
    for (std::uint64_t first = geometry_.result_delay_columns; first < end(); first += width()) {
      columns.push_back(first);
      add_row_ends(kResultGroup, first, columns);
    }
    std::stable_sort(columns.begin(), columns.end());  // quick, because most are two sorted lists
    columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
    return columns;
  }
  // Sets a key to the accesses that come with a column.
  void of(std::uint64_t column, Key& key) const {
    key.assign(1, std::uint64_t{column >= geometry_.result_delay_columns} |
                      std::uint64_t{column >= geometry_.columns} << 1U |
                      std::uint64_t{column >= fewer_rows_column()} << 2U);
    if (column < geometry_.columns) {
      std::uint64_t empty = 0;
      for (int k = 0; k < geometry_.slots_per_column; ++k)
        empty |= std::uint64_t{!geometry_.is_inside(static_cast<int>(first_row(0, column)) + k)} << k;
      key.push_back(empty);
      for (std::size_t group = 0; group < kResultGroup; ++group) add_rows(group, column, key);
    }
    if (column >= geometry_.result_delay_columns) add_rows(kResultGroup, column, key);
  }
  // Sets a key to how far the rows from which open rows are counted move with a column.
  void moves(std::uint64_t column, Key& key) const {
    key.clear();
    for (const SdramPart& part : sdram_)
      add_signed(
          column == 0 ? 0 : origin_row(geometry_, part, column) - origin_row(geometry_, part, column - 1),
          key);
  }
  std::uint64_t end() const {
    return geometry_.columns + static_cast<std::uint64_t>(geometry_.drain_columns);
  }

 private:
  static void add_signed(std::int64_t number, Key& key) { key.push_back(static_cast<std::uint64_t>(number)); }
  // The first column whose strip of results has fewer rows inside the image; if there is none, the end.
  std::uint64_t fewer_rows_column() const {
    return geometry_.last_rows != geometry_.rows ? geometry_.last_strip_column : end();
  }
  std::uint64_t width() const { return geometry_.columns_per_strip(); }
  // The first row that a port group accesses with a column, and how many.
  std::int64_t first_row(std::size_t group, std::uint64_t column) const {
    return geometry_.first_row_at(group == kResultGroup, column);
  }
  int row_count(std::size_t group) const {
    return group == kResultGroup ? geometry_.rows : geometry_.slots_per_column;
  }
  static std::int64_t pixels_of_word(std::size_t group) {
    return kPortGroups[group].bytes_per_pixel == 4 ? 1 : kernels::kPixelsPerWord;
  }
  bool has_row(const SdramPart& part, std::int64_t row) const {
    return row >= 0 && row < geometry_.height &&
           floor_remainder(row, part.parts) == static_cast<std::uint64_t>(part.number);
  }
  // Adds in which part of its buffer a group has the rows of a column, and in which rows of sdram.
  void add_rows(std::size_t group, std::uint64_t column, Key& key) const {
    if (!has_group(config_, group)) return;
    const std::int64_t first = first_row(group, column);
    if (const auto parts = static_cast<std::int64_t>(placements_[group].parts().size()); parts > 1)
      key.push_back(floor_remainder(first, parts));
    const std::uint64_t delay = group == kResultGroup ? geometry_.result_delay_columns : 0;
    const auto word_of_row = static_cast<std::int64_t>((column - delay) % width()) / pixels_of_word(group);
    for (const SdramPart& part : sdram_) {
      if (part.group != group) continue;
      for (std::int64_t row = first; row < first + row_count(group); ++row) {
        if (has_row(part, row))
          add_signed((part.word_of(row) + word_of_row) / part.row_words - origin_row(geometry_, part, column),
                     key);
      }
    }
  }
  // Adds the columns of the strip that begins with `first` where a row of the buffer goes on in the next row
  // of sdram.
  void add_row_ends(std::size_t group, std::uint64_t first, std::vector<std::uint64_t>& columns) const {
    for (const SdramPart& part : sdram_) {
      if (part.group != group) continue;
      const std::int64_t first_row = this->first_row(group, first);
      for (std::int64_t row = first_row; row < first_row + row_count(group); ++row) {
        if (!has_row(part, row)) continue;
        for (std::int64_t word = part.row_words - part.word_of(row) % part.row_words; word < part.line_words;
             word += part.row_words)
          columns.push_back(first + static_cast<std::uint64_t>(word * pixels_of_word(group)));
      }
    }
  }

  const CoreConfig& config_;
  FrameGeometry geometry_;
  const Placements& placements_;
  const std::vector<SdramPart>& sdram_;
};

}  // namespace

// A column sees the changes up to `ahead` columns after it, and those less than `behind` columns before it.
// Its number stands for the accesses before these changes, and for the changes.
FramePlaces::FramePlaces(const CoreConfig& config, std::uint64_t ahead, std::uint64_t behind,
                         const Placements& placements, const std::vector<SdramPart>& sdram) {
  struct Change {
    std::uint64_t column;
    std::uint64_t accesses;
    std::uint64_t moves;
  };
  const Accesses accesses(config, placements, sdram);
  end_ = accesses.end();
  Numbers keys;
  std::vector<Change> changes;
  Key none;  // no row moves
  accesses.moves(0, none);
  Key key;
  Key last;
  Key moves;
  for (const std::uint64_t column : accesses.changes()) {
    accesses.of(column, key);
    accesses.moves(column, moves);
    if (!changes.empty() && key == last && moves == none) continue;
    changes.push_back({column, keys.of(key), keys.of(moves)});
    last.swap(key);
  }
  Numbers numbers;
  std::size_t first = 0;  // the first change that the column sees
  for (std::uint64_t column = 0; column < end_;) {
    while (first < changes.size() && changes[first].column + behind <= column) ++first;
    key.assign(1, first == 0 ? UINT64_MAX : changes[first - 1].accesses);
    std::size_t next = first;
    for (; next < changes.size() && changes[next].column <= column + ahead; ++next) {
      for (const std::uint64_t word :
           {changes[next].column - column, changes[next].accesses, changes[next].moves})
        key.push_back(word);
    }
    runs_.push_back({column, numbers.of(key)});
    if (next != first) {
      ++column;
    } else {
      column = next == changes.size() ? end_ : changes[next].column - ahead;
    }
  }
}

// Most often the column lies in the run that was asked for last, or in one of the next.
FramePlaces::Place FramePlaces::at(std::uint64_t column) const {
  if (column < runs_[last_].first) last_ = 0;
  while (last_ + 1 < runs_.size() && runs_[last_ + 1].first <= column) ++last_;
  return {runs_[last_].number, last_ + 1 < runs_.size() ? runs_[last_ + 1].first : end_};
}

}  // namespace stereotlm::fpga
