#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

#include "models/fpga/frame_geometry.h"

namespace stereotlm::trace {

// The place of a slot in the picture.
struct SlotPlace {
  std::uint64_t strip = 0;
  int row = 0;  // may lie outside the image
  int column = 0;
};

// Which pixel a slot is for, and which slots a word of the result depends on.
class SlotPlaces {
 public:
  explicit SlotPlaces(const fpga::FrameGeometry& geometry) : geometry_(geometry) {}

  SlotPlace place(std::uint64_t slot) const {
    const auto slots = static_cast<std::uint64_t>(geometry_.slots_per_column);
    const std::uint64_t column = slot / slots;
    const std::uint64_t strip = column / geometry_.columns_per_strip();
    return {strip, geometry_.first_row_of(static_cast<int>(strip)) + static_cast<int>(slot % slots),
            static_cast<int>(column % geometry_.columns_per_strip())};
  }

  // The row and the first column of the four disparities in a word of the result.
  SlotPlace place_of_word(std::uint64_t word) const {
    const std::uint64_t row_words = geometry_.columns_per_strip() / 4;
    const std::uint64_t place = geometry_.place_of_result_word(word);
    const std::uint64_t row = place / row_words;
    return {
        row / static_cast<std::uint64_t>(geometry_.rows) + static_cast<std::uint64_t>(geometry_.lead_strips),
        static_cast<int>(row), static_cast<int>(4 * (place % row_words))};
  }

  // The slots of the pixels whose disparities the word holds. With the fetch `column` a pixel has several
  // slots: this is the one in the strip of the result. There is none if the filter takes the pixel from an
  // earlier strip.
  std::optional<std::array<std::uint64_t, 4>> slots_of_word(std::uint64_t word) const {
    const SlotPlace result = place_of_word(word);
    const bool is_column = geometry_.slots_per_column > 1;
    const auto strip = is_column ? static_cast<int>(result.strip) : result.row;
    const int k = result.row - geometry_.first_row_of(strip);
    if (k < 0 || k >= geometry_.slots_per_column) return std::nullopt;
    std::array<std::uint64_t, 4> slots{};
    for (std::uint64_t i = 0; i < slots.size(); ++i) {
      const std::uint64_t column = static_cast<std::uint64_t>(strip) * geometry_.columns_per_strip() +
                                   static_cast<std::uint64_t>(result.column) + i;
      slots[i] =
          column * static_cast<std::uint64_t>(geometry_.slots_per_column) + static_cast<std::uint64_t>(k);
    }
    return slots;
  }

 private:
  fpga::FrameGeometry geometry_;
};

}  // namespace stereotlm::trace
