#include "models/fpga/fast/frame_areas.h"

#include <algorithm>
#include <map>
#include <utility>

namespace stereotlm::fpga {
namespace {

using Key = std::vector<std::uint64_t>;

std::uint64_t remainder(std::int64_t number, std::size_t divisor) {
  const auto signed_divisor = static_cast<std::int64_t>(divisor);
  return static_cast<std::uint64_t>((number % signed_divisor + signed_divisor) % signed_divisor);
}

// Divides the columns of a frame.
class Division {
 public:
  Division(const CoreConfig& config, std::uint64_t columns, std::uint64_t result_columns,
           const Placements& placements)
      : geometry_(config),
        width_(geometry_.columns_per_strip()),
        end_(geometry_.columns + static_cast<std::uint64_t>(geometry_.drain_columns)),
        columns_(columns),
        result_parts_(placements[kResultGroup].parts().size()) {
    for (std::size_t group = 0; group < kResultGroup; ++group) {
      if (has_group(config, group)) reader_parts_.push_back(placements[group].parts().size());
    }
    for (int strip = 0; strip < geometry_.strips; ++strip) strips_.push_back(key_of_strip(strip));
    if (static_cast<std::size_t>(geometry_.rows) % result_parts_ != 0) result_columns_ = result_columns;
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
      end -= (end - geometry_.result_delay_columns) % 4;
      if (end >= first + 8 && end <= end_) found.push_back({first, end});
    };
    for (std::uint64_t first = 0; first < end_;) {
      const std::uint64_t change = next_change(first);
      const std::uint64_t last = change == end_ ? end_ : std::max(first, change - std::min(change, columns_));
      std::uint64_t from = std::max(first, last_result_change(first) + result_columns_);
      for (std::uint64_t to = next_result_change(from); to < last; to = next_result_change(from)) {
        if (from < to) add(from, to);
        from = to + result_columns_;
      }
      if (from < last) add(from, last);
      first = change;
    }
    return found;
  }
  Key uniform_key(std::uint64_t column) const {
    Key key = column < geometry_.columns ? strips_[column / width_] : Key{UINT64_MAX};
    key.push_back(result_part(column));
    return key;
  }

  // The end of a part of an area that is not uniform, from `first` on. `end`: of all of it.
  std::uint64_t end_of_part(std::uint64_t first, std::uint64_t end) const {
    return std::min(end, group_end_from((first / width_ + 1) * width_));
  }
  Key key_of_part(std::uint64_t first, std::uint64_t end) const {
    const std::uint64_t place = first - std::min(first, result_columns_);
    const std::uint64_t strip = place / width_;
    Key key{first - strip * width_, end - first, result_part(first)};
    for (std::uint64_t column = strip * width_; column < end + columns_; column += width_) {
      if (column >= geometry_.columns) {
        key.push_back(geometry_.columns - strip * width_);
        break;
      }
      const Key& of_strip = strips_[column / width_];
      key.insert(key.end(), of_strip.begin(), of_strip.end());
    }
    return key;
  }
  std::uint64_t end() const { return end_; }

 private:
  // The slots of a strip: those that are empty, and the parts of the buffers that hold the first one's row.
  Key key_of_strip(int strip) const {
    Key key{0};
    const int first_row = geometry_.first_row_of(strip);
    for (int k = 0; k < geometry_.slots_per_column; ++k)
      key[0] |= std::uint64_t{!geometry_.is_inside(first_row + k)} << k;
    for (const std::size_t parts : reader_parts_) key.push_back(remainder(first_row, parts));
    return key;
  }
  // The number of the strip whose results leave with a column; negative before the first.
  std::int64_t result_strip(std::uint64_t column) const {
    const auto behind = static_cast<std::int64_t>(column - geometry_.result_delay_columns);
    const auto width = static_cast<std::int64_t>(width_);
    return behind >= 0 ? behind / width : -1 - (-1 - behind) / width;
  }
  std::uint64_t result_part(std::uint64_t column) const {
    return remainder(result_strip(column) * geometry_.rows, result_parts_);
  }

  std::uint64_t group_end_from(std::uint64_t column) const {
    return std::min(column + (geometry_.result_delay_columns - column) % 4, end_);
  }
  // The first column behind this one with other slots.
  std::uint64_t next_change(std::uint64_t column) const {
    if (column >= geometry_.columns) return end_;
    std::size_t strip = column / width_ + 1;
    while (strip < strips_.size() && strips_[strip] == strips_[strip - 1]) ++strip;
    return strip * width_;
  }
  // The first column from this one on with whose end results go to another strip, and the last one up to it.
  std::uint64_t next_result_change(std::uint64_t column) const {
    if (result_columns_ == 0) return UINT64_MAX;
    return column + remainder(static_cast<std::int64_t>(geometry_.result_delay_columns - column), width_);
  }
  std::uint64_t last_result_change(std::uint64_t column) const {
    return column < geometry_.result_delay_columns || result_columns_ == 0
               ? 0
               : column - (column - geometry_.result_delay_columns) % width_;
  }

  FrameGeometry geometry_;
  std::uint64_t width_;
  std::uint64_t end_;  // of the drain
  std::uint64_t columns_;
  std::uint64_t result_columns_ = 0;  // 0: all results go to parts in the same way
  std::vector<std::size_t> reader_parts_;
  std::size_t result_parts_;
  std::vector<Key> strips_;
};

}  // namespace

FrameAreas::FrameAreas(const CoreConfig& config, std::uint64_t columns, std::uint64_t result_columns,
                       const Placements& placements) {
  const Division division(config, columns, result_columns, placements);
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
  const auto next = std::upper_bound(
      areas_.begin(), areas_.end(), column,
      [](std::uint64_t sought, const Area& area) { return sought < area.first; });
  return *(next - 1);
}

}  // namespace stereotlm::fpga
