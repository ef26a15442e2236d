#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace stereotlm::calib {

// A value of a text in OpenCV's FileStorage format, with its line; calibration_reader.cpp uses it.
struct StorageValue {
  enum class Kind { kScalar, kList, kMap };

  Kind kind = Kind::kScalar;
  int line = 1;  // from 1
  bool quoted = false;
  std::string text;                 // of a scalar; empty if the value is missing
  std::vector<StorageValue> items;  // of a list, or of a map in the order of `keys`
  std::vector<std::string> keys;    // of a map; each key occurs once

  // Null if the map does not have the key.
  const StorageValue* find(const std::string& key) const;
};

// Limits of the texts that parse_storage() accepts. Each pair of pictures of a calibration adds 60 bytes and
// two paths.
inline constexpr std::size_t kMostStorageBytes = 1'000'000;
inline constexpr std::size_t kMostStorageDepth = 8;  // nested maps and lists

// Parses a text, and returns its root, which is a map. The two limits bound memory and stack for any text;
// OpenCV's own parser has no such limits. Throws std::runtime_error `line N: what was found: rule`.
StorageValue parse_storage(const std::string& text);

}  // namespace stereotlm::calib
