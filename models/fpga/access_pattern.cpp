#include "models/fpga/access_pattern.h"

#include <algorithm>

#include "models/kernels/rectification_table.h"

namespace stereotlm::fpga {

AccessPattern::AccessPattern(const FrameGeometry& geometry)
    : geometry_(geometry),
      words_((static_cast<std::size_t>(geometry.width) + 63) / 64),
      valid_(words_ * static_cast<std::size_t>(geometry.height)),
      changes_(words_ * static_cast<std::size_t>(geometry.strips)),
      invalid_before_strip_(static_cast<std::size_t>(geometry.strips)),
      next_change_(static_cast<std::size_t>(geometry.strips)) {
  for (int row = 0; row < geometry.height; ++row) {
    set_all(valid_.data() + static_cast<std::size_t>(row) * words_);
  }
  find_changes();
  all_valid_ = true;
}

void AccessPattern::set_all(std::uint64_t* row_bits) const {
  std::fill_n(row_bits, words_, ~std::uint64_t{0});
  if (geometry_.width % 64 != 0) row_bits[words_ - 1] = (std::uint64_t{1} << geometry_.width % 64) - 1;
}

void AccessPattern::set_entries(const std::uint32_t* entries) {
  const bool were_all_valid = all_valid_;
  all_valid_ = true;
  for (int row = 0; row < geometry_.height; ++row) {
    std::uint64_t* const bits = valid_.data() + static_cast<std::size_t>(row) * words_;
    std::uint32_t common = ~std::uint32_t{0};
    for (int column = 0; column < geometry_.width; ++column) common &= entries[column];
    if (kernels::entry_is_valid(common)) {
      set_all(bits);
      entries += geometry_.width;
      continue;
    }
    all_valid_ = false;
    for (std::size_t word = 0; word < words_; ++word) {
      const int count = std::min(64, geometry_.width - static_cast<int>(word) * 64);
      std::uint64_t found = 0;
      for (int i = 0; i < count; ++i) found |= std::uint64_t{kernels::entry_is_valid(entries[i])} << i;
      bits[word] = found;
      entries += count;
    }
  }
  if (!(all_valid_ && were_all_valid)) find_changes();
}

void AccessPattern::find_changes() {
  empty_slots_ = 0;
  pixel_accesses_ = 0;
  const std::vector<std::uint64_t> valid = valid_in_rows();
  for (int strip = 0; strip < geometry_.strips; ++strip) find_changes_of_strip(strip, valid);
  find_strips_with_changes();
}

std::vector<std::uint64_t> AccessPattern::valid_in_rows() const {
  std::vector<std::uint64_t> valid(static_cast<std::size_t>(geometry_.height));
  for (int row = 0; row < geometry_.height; ++row) {
    for (std::size_t word = 0; word < words_; ++word)
      valid[static_cast<std::size_t>(row)] +=
          static_cast<std::uint64_t>(__builtin_popcountll(valid_row(row)[word]));
  }
  return valid;
}

// To be called for the strips in their order, because it adds to the counts of the strips before.
void AccessPattern::find_changes_of_strip(int strip, const std::vector<std::uint64_t>& valid_in_rows) {
  std::uint64_t* const changes = changes_.data() + static_cast<std::size_t>(strip) * words_;
  std::fill_n(changes, words_, std::uint64_t{0});
  const std::uint64_t slots_before = static_cast<std::uint64_t>(strip) * geometry_.columns_per_strip() *
                                     static_cast<std::uint64_t>(geometry_.slots_per_column);
  invalid_before_strip_[static_cast<std::size_t>(strip)] = slots_before - empty_slots_ - pixel_accesses_;
  for (int k = 0; k < geometry_.slots_per_column; ++k) {
    const int row = geometry_.first_row_of(strip) + k;
    if (!inside(row)) {
      empty_slots_ += geometry_.columns_per_strip();
      continue;
    }
    pixel_accesses_ += valid_in_rows[static_cast<std::size_t>(row)];
    const std::uint64_t* const bits = valid_row(row);
    std::uint64_t before = bits[0] & 1U;  // there is no column before the first one
    for (std::size_t word = 0; word < words_; ++word) {
      changes[word] |= bits[word] ^ (bits[word] << 1U | before);
      before = bits[word] >> 63U;
    }
  }
  if (geometry_.width % 64 != 0) changes[words_ - 1] &= (std::uint64_t{1} << geometry_.width % 64) - 1;
  if (strip > 0 && !strip_begins_alike(strip)) changes[0] |= 1U;
}

void AccessPattern::find_strips_with_changes() {
  auto next = static_cast<std::uint32_t>(geometry_.strips);
  for (int strip = geometry_.strips - 1; strip >= 0; --strip) {
    const auto first = changes_.begin() + static_cast<std::ptrdiff_t>(words_) * strip;
    const auto last = first + static_cast<std::ptrdiff_t>(words_);
    if (std::any_of(first, last, [](std::uint64_t word) { return word != 0; }))
      next = static_cast<std::uint32_t>(strip);
    next_change_[static_cast<std::size_t>(strip)] = next;
  }
}

// Whether the first column of a strip makes the same accesses as the last column of the strip before.
bool AccessPattern::strip_begins_alike(int strip) const {
  for (int k = 0; k < geometry_.slots_per_column; ++k) {
    const int row = geometry_.first_row_of(strip) + k;
    const int row_before = geometry_.first_row_of(strip - 1) + k;
    if (inside(row) != inside(row_before)) return false;
    if (inside(row) && entry_valid(0, row) != entry_valid(geometry_.width - 1, row_before)) return false;
  }
  return true;
}

std::uint64_t AccessPattern::invalid_before(std::uint64_t slots) const {
  const auto slots_per_column = static_cast<std::uint64_t>(geometry_.slots_per_column);
  const std::uint64_t slots_per_strip = geometry_.columns_per_strip() * slots_per_column;
  const std::uint64_t strip = slots / slots_per_strip;
  if (strip == static_cast<std::uint64_t>(geometry_.strips))
    return geometry_.slots - empty_slots_ - pixel_accesses_;
  std::uint64_t invalid = invalid_before_strip_[strip];
  for (std::uint64_t slot = strip * slots_per_strip; slot < slots; ++slot) {
    const Place place = place_of(slot);
    if (inside(place.row) && !entry_valid(place.column, place.row)) ++invalid;
  }
  return invalid;
}

bool AccessPattern::needs_pixel(std::uint64_t slot) const {
  const Place place = place_of(slot);
  return inside(place.row) && entry_valid(place.column, place.row);
}

AccessPattern::Place AccessPattern::place_of(std::uint64_t slot) const {
  const auto slots_per_column = static_cast<std::uint64_t>(geometry_.slots_per_column);
  const std::uint64_t column = slot / slots_per_column;
  const std::uint64_t strip = column / geometry_.columns_per_strip();
  return {static_cast<int>(column % geometry_.columns_per_strip()),
          geometry_.first_row_of(static_cast<int>(strip)) + static_cast<int>(slot % slots_per_column)};
}

std::uint64_t AccessPattern::uniform_until(std::uint64_t frame_column) const {
  const std::uint64_t width = geometry_.columns_per_strip();
  const auto strips = static_cast<std::size_t>(geometry_.strips);
  const std::uint64_t next = frame_column + 1;
  auto strip = static_cast<std::size_t>(next / width);
  std::size_t place = next % width;  // column in the strip
  while (strip < strips) {
    const std::uint64_t* const changes = changes_.data() + strip * words_;
    std::uint64_t mask = ~std::uint64_t{0} << place % 64;
    for (std::size_t word = place / 64; word < words_; ++word, mask = ~std::uint64_t{0}) {
      const std::uint64_t found = changes[word] & mask;
      if (found != 0) return strip * width + word * 64 + static_cast<std::uint64_t>(__builtin_ctzll(found));
    }
    place = 0;
    if (++strip < strips) strip = next_change_[strip];
  }
  return strips * width;
}

}  // namespace stereotlm::fpga
