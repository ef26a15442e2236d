#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace stereotlm::calib {

// A value in a text of OpenCV's FileStorage, with its line.
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

// Limits of such a text. Each pair of pictures of a calibration adds 60 bytes and two paths.
inline constexpr std::size_t kMostStorageBytes = 1'000'000;
inline constexpr std::size_t kMostStorageDepth = 8;  // nested maps and lists

// The root of the text, which is a map. The two limits bound memory and stack for any text, which OpenCV's
// own parser does not. Throws std::runtime_error `line N: what was found: rule`.
StorageValue parse_storage(const std::string& text);

}  // namespace stereotlm::calib
