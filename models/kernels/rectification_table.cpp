#include "models/kernels/rectification_table.h"

#include <cstddef>
#include <cstdio>
#include <stdexcept>

#include "models/checked.h"
#include "models/kernels/simd.h"

namespace stereotlm::kernels {
namespace {

constexpr std::size_t kMostProblems = 10;

std::string entry_name(const RectificationTable& table, std::size_t index) {
  const auto width = static_cast<std::size_t>(table.width);
  char text[64];
  std::snprintf(text, sizeof text, "entry (%zu, %zu) = 0x%08x", index % width, index / width,
                table.entries[index]);
  return text;
}

}  // namespace

RectificationTable identity_table(int width, int height, int offset) {
  RectificationTable table{width, height, {}};
  if (width > 0 && height > 0)
    table.entries.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  const int first = std::max(0, -offset);
  const int end = std::min(width, width - offset);
  std::uint32_t* entries = table.entries.data();
  for (int row = 0; row < height; ++row, entries += width) {
    for (int column = first; column < end; ++column) entries[column] = make_entry(column + offset, row);
  }
  return table;
}

// Has no branches, so that the compiler can use vectors.
bool entries_point_inside(const std::uint32_t* entries, std::size_t count, int width, int height) {
  std::uint32_t outside = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t entry = entries[i];
    // Negative if the position is beyond the last column or row.
    const auto columns_left = static_cast<std::uint32_t>(width - 1 - entry_column(entry));
    const auto rows_left = static_cast<std::uint32_t>(height - 1 - entry_row(entry));
    outside |= (columns_left | rows_left) & entry;
  }
  return (outside & kEntryValid) == 0;
}

std::vector<std::string> problems(const RectificationTable& table) {
  if (table.width < 1 || table.width > 2048 || table.height < 1 || table.height > 2048) {
    return {"table size = " + std::to_string(table.width) + " x " + std::to_string(table.height) +
            ": must be 1..2048 each"};
  }
  const int pixels = table.width * table.height;
  if (table.entries.size() != static_cast<std::size_t>(pixels)) {
    return {"table entries = " + std::to_string(table.entries.size()) +
            ": must be width * height = " + std::to_string(pixels)};
  }
  std::uint32_t bits = 0;
  for (const std::uint32_t entry : table.entries) bits |= entry;
  if ((bits & kEntryUnusedBits) == 0 &&
      entries_point_inside(table.entries.data(), table.entries.size(), table.width, table.height))
    return {};
  std::vector<std::string> found;
  for (std::size_t index = 0; index < table.entries.size() && found.size() < kMostProblems; ++index) {
    const std::uint32_t entry = table.entries[index];
    if ((entry & kEntryUnusedBits) != 0) {
      found.push_back(entry_name(table, index) + ": bits 30..27 and 15..11 must be 0");
    } else if (entry_is_valid(entry) &&
               (entry_column(entry) >= table.width || entry_row(entry) >= table.height)) {
      found.push_back(entry_name(table, index) + ": a valid source position must lie inside the " +
                      std::to_string(table.width) + " x " + std::to_string(table.height) + " image");
    }
  }
  return found;
}

void require_usable(const RectificationTable& table, const GrayImage& image) {
  if (image.width != table.width || image.height != table.height) {
    throw std::invalid_argument("rectify: image of " + std::to_string(image.width) + " x " +
                                std::to_string(image.height) + " with a table of " +
                                std::to_string(table.width) + " x " + std::to_string(table.height));
  }
  checked("rectify", table);
}

GrayImage rectify(const GrayImage& source, const RectificationTable& table) {
  require_usable(table, source);
  GrayImage rectified(table.width, table.height);
  best_simd().rectify(source.pixels.data(), table.entries.data(), static_cast<int>(table.entries.size()),
                      table.width, rectified.pixels.data());
  return rectified;
}

}  // namespace stereotlm::kernels
