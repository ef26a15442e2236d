#include "models/fpga/access_pattern.h"

#include <algorithm>

#include "models/kernels/rectification_table.h"
#include "models/kernels/words.h"

namespace stereotlm::fpga {

AccessPattern::AccessPattern(const FrameGeometry& geometry, PixelCache cache)
    : geometry_(geometry),
      has_cache_(cache == PixelCache::kWord),
      words_((static_cast<std::size_t>(geometry.width) + 63) / 64),
      pixels_(words_ * static_cast<std::size_t>(geometry.height)),
      counts_(static_cast<std::size_t>(geometry.height)),
      needs_all_pixels_(!has_cache_) {
  std::vector<std::uint64_t> row_bits(words_);
  std::uint64_t row_count = 0;
  for (int column = 0; column < geometry.width; ++column) {
    if (has_cache_ && !begins_word(column)) continue;
    row_bits[static_cast<std::size_t>(column) / 64] |= std::uint64_t{1} << column % 64;
    ++row_count;
  }
  for (int row = 0; row < geometry.height; ++row) {
    std::copy(row_bits.begin(), row_bits.end(), pixels_.begin() + static_cast<std::ptrdiff_t>(words_) * row);
    counts_[static_cast<std::size_t>(row)] = row_count;
  }
  count();
}

void AccessPattern::set_all(std::uint64_t* row_bits) const {
  std::fill_n(row_bits, words_, ~std::uint64_t{0});
  if (geometry_.width % 64 != 0) row_bits[words_ - 1] = (std::uint64_t{1} << geometry_.width % 64) - 1;
}

void AccessPattern::set_entries(const std::uint32_t* entries) {
  entries_ = entries;
  pixels_of_rows_.clear();
  const bool needed_all_pixels = needs_all_pixels_;
  needs_all_pixels_ = true;
  is_identity_ = true;
  for (int row = 0; row < geometry_.height; ++row, entries += geometry_.width) {
    if (!(has_cache_ ? set_row_cached(row, entries) : set_row(row, entries))) needs_all_pixels_ = false;
    is_identity_ = is_identity_ && are_own_sources(row, entries);
  }
  if (needs_all_pixels_ && needed_all_pixels) return;
  slots_.clear();
  count();
}

bool AccessPattern::are_own_sources(int row, const std::uint32_t* entries) const {
  std::uint32_t differing = 0;
  for (int column = 0; column < geometry_.width; ++column)
    differing |= entries[column] ^ kernels::make_entry(column, row);
  return differing == 0;
}

// Returns whether all pixels of the row are accessed.
bool AccessPattern::set_row(int row, const std::uint32_t* entries) {
  std::uint64_t* const bits = pixels_.data() + static_cast<std::size_t>(row) * words_;
  std::uint64_t& count = counts_[static_cast<std::size_t>(row)];
  std::uint32_t common = ~std::uint32_t{0};
  for (int column = 0; column < geometry_.width; ++column) common &= entries[column];
  if (kernels::entry_is_valid(common)) {
    set_all(bits);
    count = geometry_.columns_per_strip();
    return true;
  }
  count = 0;
  for (std::size_t word = 0; word < words_; ++word) {
    const int columns = std::min(64, geometry_.width - static_cast<int>(word) * 64);
    common = ~std::uint32_t{0};
    std::uint32_t any = 0;
    for (int i = 0; i < columns; ++i) {
      common &= entries[i];
      any |= entries[i];
    }
    std::uint64_t found = 0;
    if (kernels::entry_is_valid(common)) {
      found = ~std::uint64_t{0} >> (64 - columns);
    } else if (kernels::entry_is_valid(any)) {
      for (int i = 0; i < columns; ++i) found |= std::uint64_t{kernels::entry_is_valid(entries[i])} << i;
    }
    bits[word] = found;
    count += static_cast<std::uint64_t>(__builtin_popcountll(found));
    entries += columns;
  }
  return false;
}

bool AccessPattern::set_row_cached(int row, const std::uint32_t* entries) {
  constexpr std::uint32_t kNoWord = UINT32_MAX;
  const auto width = static_cast<std::uint32_t>(geometry_.width);
  std::uint64_t* const bits = pixels_.data() + static_cast<std::size_t>(row) * words_;
  std::uint64_t& count = counts_[static_cast<std::size_t>(row)];
  std::fill_n(bits, words_, std::uint64_t{0});
  count = 0;
  std::uint32_t cached = kNoWord;
  for (std::uint32_t column = 0; column < width; ++column) {
    const std::uint32_t entry = entries[column];
    if (!kernels::entry_is_valid(entry)) continue;
    const std::uint32_t word = (static_cast<std::uint32_t>(kernels::entry_row(entry)) * width +
                                static_cast<std::uint32_t>(kernels::entry_column(entry))) /
                               kernels::kPixelsPerWord;
    if (word == cached) continue;
    cached = word;
    bits[column / 64] |= std::uint64_t{1} << column % 64;
    ++count;
  }
  return count == width;
}

void AccessPattern::count() {
  const auto lanes = static_cast<std::size_t>(geometry_.lanes);
  table_accesses_.assign(lanes, 0);
  pixel_accesses_.assign(lanes, 0);
  for (int strip = 0; strip < geometry_.strips; ++strip) {
    for (int k = 0; k < geometry_.slots_per_column; ++k) {
      const int row = geometry_.first_row_of(strip) + k;
      if (!geometry_.is_inside(row)) continue;
      table_accesses_[static_cast<std::size_t>(k) % lanes] += geometry_.columns_per_strip();
      pixel_accesses_[static_cast<std::size_t>(k) % lanes] += counts_[static_cast<std::size_t>(row)];
    }
  }
}

void AccessPattern::set_slots() const {
  // A query begins up to 256 slots beyond the end of the frame, and reads two words.
  slots_.resize((geometry_.slots + 256) / 64 + 2);
  const auto slots_per_column = static_cast<std::uint64_t>(geometry_.slots_per_column);
  for (int strip = 0; strip < geometry_.strips; ++strip) {
    const std::uint64_t first_slot =
        static_cast<std::uint64_t>(strip) * geometry_.columns_per_strip() * slots_per_column;
    for (int k = 0; k < geometry_.slots_per_column; ++k) {
      const int row = geometry_.first_row_of(strip) + k;
      if (!geometry_.is_inside(row)) continue;
      const std::uint64_t* const bits = pixels_of_row(row);
      for (std::size_t word = 0; word < words_; ++word) {
        const std::uint64_t first = first_slot + word * 64 * slots_per_column + static_cast<std::uint64_t>(k);
        for (std::uint64_t left = bits[word]; left != 0; left &= left - 1) {
          const auto column = static_cast<std::uint64_t>(__builtin_ctzll(left));
          const std::uint64_t slot = first + column * slots_per_column;
          slots_[slot / 64] |= std::uint64_t{1} << slot % 64;
        }
      }
    }
  }
}

const AccessPattern::RowAccesses& AccessPattern::table_accesses_of_rows() const {
  if (!entries_of_rows_.empty()) return entries_of_rows_;
  entries_of_rows_.assign(table_accesses_.size(),
                          std::vector<std::uint64_t>(static_cast<std::size_t>(geometry_.height)));
  for (int strip = 0; strip < geometry_.strips; ++strip) {
    for (int k = 0; k < geometry_.slots_per_column; ++k) {
      const int row = geometry_.first_row_of(strip) + k;
      if (geometry_.is_inside(row))
        entries_of_rows_[static_cast<std::size_t>(k % geometry_.lanes)][static_cast<std::size_t>(row)] +=
            geometry_.columns_per_strip();
    }
  }
  return entries_of_rows_;
}

const AccessPattern::RowAccesses& AccessPattern::pixel_accesses_of_rows() const {
  if (!pixels_of_rows_.empty()) return pixels_of_rows_;
  const RowAccesses& slots = table_accesses_of_rows();
  pixels_of_rows_.assign(slots.size(), std::vector<std::uint64_t>(slots.front().size()));
  const auto add = [&](int row, int source, std::uint64_t pixels) {
    for (std::size_t lane = 0; lane < slots.size(); ++lane)
      pixels_of_rows_[lane][static_cast<std::size_t>(source)] +=
          slots[lane][static_cast<std::size_t>(row)] / geometry_.columns_per_strip() * pixels;
  };
  for (int row = 0; row < geometry_.height; ++row) {
    if (is_identity_) {
      add(row, row, counts_[static_cast<std::size_t>(row)]);
      continue;
    }
    for (int column = 0; column < geometry_.width; ++column) {
      if (needs_pixel(column, row)) add(row, kernels::entry_row(entry(column, row)), 1);
    }
  }
  return pixels_of_rows_;
}

}  // namespace stereotlm::fpga
