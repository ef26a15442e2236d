#include "models/fpga/fast/frame_areas.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

namespace stereotlm::fpga {
namespace {

using Key = std::vector<std::uint64_t>;

constexpr std::uint64_t kGroup = 4;  // columns

// Divides the columns of a frame.
class Division {
 public:
  Division(const CoreConfig& config, std::uint64_t columns, std::uint64_t result_columns,
           const Placements& placements, const std::vector<SdramPart>& sdram)
      : geometry_(config),
        width_(geometry_.columns_per_strip()),
        end_(geometry_.columns + static_cast<std::uint64_t>(geometry_.drain_columns)),
        columns_(columns),
        result_columns_(result_columns),
        sdram_(sdram) {
    for (std::size_t group = 0; group < kCoreGroupCount; ++group)
      parts_[group] = has_group(config, group) ? static_cast<int>(placements[group].parts().size()) : 1;
    for (const SdramPart& part : sdram) (part.group == kResultGroup ? writes_sdram_ : reads_sdram_) = true;
    find_changes();
    find_result_changes();
  }

  // Columns that are alike, from `first` up to `end`.
  struct Uniform {
    std::uint64_t first;
    std::uint64_t end;
  };
  std::vector<Uniform> uniform_areas() const {
    std::vector<Uniform> found;
    const auto add = [&](std::uint64_t first, std::uint64_t end) {
      if (first != 0) first = group_end_from(first);
      end -= (end - geometry_.result_delay_columns) % kGroup;
      if (end >= first + 2 * kGroup && end <= end_) found.push_back({first, end});
    };
    for (std::size_t change = 0; change + 1 < changes_.size(); ++change) {
      const std::uint64_t next = changes_[change + 1];
      // The drain has no slots to look ahead to.
      const std::uint64_t last = next - std::min(next, next == end_ ? kGroup : columns_);
      std::uint64_t first = changes_[change];
      auto result = std::upper_bound(result_changes_.begin(), result_changes_.end(), first);
      if (result != result_changes_.begin()) first = std::max(first, *(result - 1) + result_columns_);
      for (; result != result_changes_.end() && *result < last + kGroup; ++result) {
        // The open rows are counted from the strip of the results: the next one's at its first column.
        if (first + kGroup < *result) add(first, *result - kGroup);
        first = *result + result_columns_;
      }
      if (first < last) add(first, last);
    }
    return found;
  }
  Key uniform_key(std::uint64_t column) const {
    Key key;
    add_slots(column, key);
    add_results(column, key);
    return key;
  }

  // The end of a part of an area that is not uniform, from `first` on. `end`: of all of it.
  std::uint64_t end_of_part(std::uint64_t first, std::uint64_t end) const {
    return std::min(end, group_end_from((first / width_ + 1) * width_));
  }
  Key key_of_part(std::uint64_t first, std::uint64_t end) const {
    Key key{end - first};
    const auto add_from = [&](std::uint64_t from, std::uint64_t to, const std::vector<std::uint64_t>& changes,
                              bool of_results) {
      (of_results ? add_results(from, key) : add_slots(from, key));
      auto change = std::upper_bound(changes.begin(), changes.end(), from);
      for (; change != changes.end() && *change < to; ++change) {
        key.push_back(*change - from);
        (of_results ? add_results(*change, key) : add_slots(*change, key));
        for (const SdramPart& part : sdram_) {
          if ((part.group == kResultGroup) == of_results)
            add_signed(origin_row(geometry_, part, *change) - origin_row(geometry_, part, *change - 1), key);
        }
      }
      key.push_back(UINT64_MAX);
    };
    add_from(first, end + columns_, changes_, false);
    const std::uint64_t behind = std::min(first, result_columns_);
    if (!result_changes_.empty()) add_from(first - behind, end + 1, result_changes_, true);
    return key;
  }
  std::uint64_t end() const { return end_; }

 private:
  static void add_signed(std::int64_t number, Key& key) { key.push_back(static_cast<std::uint64_t>(number)); }
  // Adds the slots of a column: those that are empty, and where the buffers have the rows of the others.
  void add_slots(std::uint64_t column, Key& key) const {
    if (column >= geometry_.columns) {
      key.push_back(UINT64_MAX);
      return;
    }
    const std::int64_t first_row = geometry_.first_row_at(false, column);
    std::uint64_t empty = 0;
    for (int k = 0; k < geometry_.slots_per_column; ++k)
      empty |= std::uint64_t{!geometry_.is_inside(static_cast<int>(first_row) + k)} << k;
    key.push_back(empty);
    const Rows rows{first_row, geometry_.slots_per_column, column, column % width_};
    for (std::size_t group = 0; group < kResultGroup; ++group) add_rows(group, rows, key);
  }
  // Adds where the results lie that leave with a column.
  void add_results(std::uint64_t column, Key& key) const {
    const std::int64_t first_row = geometry_.first_row_at(true, column);
    const std::uint64_t behind = column - geometry_.result_delay_columns;
    add_rows(kResultGroup, {first_row, geometry_.rows, column, behind % width_}, key);
  }
  struct Rows {
    std::int64_t first;
    int count;
    std::uint64_t column;  // of the matcher
    std::uint64_t place;   // the column of their buffer
  };
  // Adds where the buffer of a port group has rows: in which part, and in which row of sdram.
  void add_rows(std::size_t group, const Rows& rows, Key& key) const {
    if (parts_[group] > 1) key.push_back(floor_remainder(rows.first, parts_[group]));
    for (const SdramPart& part : sdram_) {
      if (part.group != group) continue;
      const std::int64_t origin = origin_row(geometry_, part, rows.column);
      for (std::int64_t row = rows.first; row < rows.first + rows.count; ++row) {
        if (!is_in(part, row)) continue;
        const std::int64_t word =
            part.word_of(row) + static_cast<std::int64_t>(rows.place / pixels_of(group));
        add_signed(word / part.row_words - origin, key);
      }
    }
  }
  bool is_in(const SdramPart& part, std::int64_t row) const {
    return row >= 0 && row < geometry_.height &&
           floor_remainder(row, part.parts) == static_cast<std::uint64_t>(part.number);
  }
  // Of a word.
  static std::uint64_t pixels_of(std::size_t group) {
    return kPortGroups[group].bytes_per_pixel == 4 ? 1 : kernels::kPixelsPerWord;
  }

  void find_changes() {
    Key before;
    for (int strip = 0; strip < geometry_.strips; ++strip) {
      const std::uint64_t first = static_cast<std::uint64_t>(strip) * width_;
      Key key;
      add_slots(first, key);
      if (reads_sdram_ || strip == 0 || key != before) changes_.push_back(first);
      before.swap(key);
      for (std::size_t group = 0; group < kResultGroup; ++group) {
        for (int k = 0; k < geometry_.slots_per_column; ++k)
          add_row_ends(group, geometry_.first_row_of(strip) + k, first, changes_);
      }
    }
    changes_.push_back(geometry_.columns);
    changes_.push_back(end_);
    sort(changes_);
  }
  void find_result_changes() {
    const bool moves = geometry_.rows % parts_[kResultGroup] != 0;
    for (std::uint64_t first = geometry_.result_delay_columns; first < end_; first += width_) {
      if (moves || writes_sdram_) result_changes_.push_back(first);
      for (int i = 0; i < geometry_.rows; ++i)
        add_row_ends(kResultGroup, geometry_.first_row_at(true, first) + i, first, result_changes_);
    }
    sort(result_changes_);
  }
  // Adds the columns from which on a row of the buffer lies in another row of sdram. `first`: of the strip.
  void add_row_ends(std::size_t group, std::int64_t row, std::uint64_t first,
                    std::vector<std::uint64_t>& columns) const {
    for (const SdramPart& part : sdram_) {
      if (part.group != group || !is_in(part, row)) continue;
      const std::int64_t left = part.row_words - part.word_of(row) % part.row_words;
      for (auto word = static_cast<std::uint64_t>(left); word * pixels_of(group) < width_;
           word += static_cast<std::uint64_t>(part.row_words))
        columns.push_back(first + word * pixels_of(group));
    }
  }
  static void sort(std::vector<std::uint64_t>& columns) {
    std::sort(columns.begin(), columns.end());
    columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
  }

  std::uint64_t group_end_from(std::uint64_t column) const {
    return std::min(column + (geometry_.result_delay_columns - column) % kGroup, end_);
  }

  FrameGeometry geometry_;
  std::uint64_t width_;
  std::uint64_t end_;  // of the drain
  std::uint64_t columns_;
  std::uint64_t result_columns_;
  std::array<int, kCoreGroupCount> parts_{};  // [port group]: of its buffer
  const std::vector<SdramPart>& sdram_;
  bool reads_sdram_ = false;
  bool writes_sdram_ = false;
  std::vector<std::uint64_t> changes_;  // the first columns of slots that are not like those before; end_
  std::vector<std::uint64_t> result_changes_;  // the same of results
};

}  // namespace

FrameAreas::FrameAreas(const CoreConfig& config, std::uint64_t columns, std::uint64_t result_columns,
                       const Placements& placements, const std::vector<SdramPart>& sdram) {
  const Division division(config, columns, result_columns, placements, sdram);
  std::map<std::pair<bool, Key>, std::uint64_t> numbers;
  const auto add = [&](std::uint64_t first, std::uint64_t end, bool is_uniform, Key key) {
    const std::uint64_t number =
        numbers.try_emplace({is_uniform, std::move(key)}, numbers.size()).first->second;
    areas_.push_back({first, end, number, is_uniform});
  };
  std::uint64_t place = 0;
  const auto add_other = [&](std::uint64_t end) {
    while (place < end) {
      const std::uint64_t end_of_part = division.end_of_part(place, end);
      add(place, end_of_part, false, division.key_of_part(place, end_of_part));
      place = end_of_part;
    }
  };
  for (const auto& [first, end] : division.uniform_areas()) {
    add_other(first);
    add(first, end, true, division.uniform_key(first));
    place = end;
  }
  add_other(division.end());
}

std::uint64_t FrameAreas::repeats(std::size_t first, std::size_t next) const {
  const auto is_alike = [](const Area& a, const Area& b) {
    return a.number == b.number && a.end - a.first == b.end - b.first;
  };
  std::size_t alike = 0;
  while (next + alike < areas_.size() && is_alike(areas_[first + alike], areas_[next + alike])) ++alike;
  return alike / (next - first);
}

const FrameAreas::Area& FrameAreas::area_of(std::uint64_t column) const {
  const auto holds = [&](std::size_t area) {
    return area < areas_.size() && areas_[area].first <= column && column < areas_[area].end;
  };
  for (const std::size_t area : {last_, last_ + 1}) {
    if (holds(area)) return areas_[last_ = area];
  }
  const auto next =
      std::upper_bound(areas_.begin(), areas_.end(), column,
                       [](std::uint64_t sought, const Area& area) { return sought < area.first; });
  last_ = static_cast<std::size_t>(next - 1 - areas_.begin());
  return areas_[last_];
}

}  // namespace stereotlm::fpga
