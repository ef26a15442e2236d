#include "calib/lut_file.h"

#include <cstdint>
#include <stdexcept>

namespace stereotlm::calib {

std::string lut_bytes(const kernels::RectificationTable& table) {
  std::string bytes;
  bytes.reserve(4 * table.entries.size());
  for (const std::uint32_t entry : table.entries) {
    for (unsigned shift = 0; shift < 32; shift += 8)
      bytes.push_back(static_cast<char>(entry >> shift & 0xFFU));
  }
  return bytes;
}

std::size_t lut_byte_count(int width, int height) {
  return 4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
}

kernels::RectificationTable parse_lut(std::string_view bytes, int width, int height) {
  const std::size_t expected = lut_byte_count(width, height);
  if (bytes.size() != expected) {
    throw std::runtime_error(std::to_string(bytes.size()) + " bytes: a table for " + std::to_string(width) +
                             "x" + std::to_string(height) + " pixels has " + std::to_string(expected));
  }
  kernels::RectificationTable table{width, height, {}};
  for (std::size_t at = 0; at < bytes.size(); at += 4) {
    std::uint32_t entry = 0;
    for (std::size_t byte = 4; byte-- > 0;) entry = entry << 8U | static_cast<std::uint8_t>(bytes[at + byte]);
    table.entries.push_back(entry);
  }
  if (const auto found = kernels::problems(table); !found.empty()) throw std::runtime_error(found.front());
  return table;
}

}  // namespace stereotlm::calib
