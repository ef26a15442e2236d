#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace stereotlm::calib {

// A value in a text of OpenCV's FileStorage, and where it stands.
struct StorageValue {
  enum class Kind { kScalar, kList, kMap };

  Kind kind = Kind::kScalar;
  int line = 1;  // from 1
  bool quoted = false;
  std::string text;                 // of a scalar; empty for a value that is left out
  std::vector<StorageValue> items;  // of a list; of a map, in the order of `keys`
  std::vector<std::string> keys;    // of a map: each once

  // Null if the map does not have the key.
  const StorageValue* find(const std::string& key) const;
};

// The rules of such a text. Each pair of pictures of a calibration adds 60 bytes and two paths.
inline constexpr std::size_t kMostStorageBytes = 1'000'000;
inline constexpr std::size_t kMostStorageDepth = 8;  // maps and lists in each other

// The text's root, which is a map. Memory and stack are bounded by the two rules, whatever the text holds:
// OpenCV's own parser is not asked. Throws std::runtime_error `line N: what was found: rule`.
StorageValue parse_storage(const std::string& text);

}  // namespace stereotlm::calib
