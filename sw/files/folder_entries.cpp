#include "sw/files/folder_entries.h"

#include <algorithm>

namespace stereotlm::files {

namespace fs = std::filesystem;

std::vector<fs::path> entries(const fs::path& folder) {
  std::vector<fs::path> names(fs::directory_iterator(folder), fs::directory_iterator{});
  for (fs::path& name : names) name = name.filename();
  std::sort(names.begin(), names.end());
  return names;
}

bool is_there(const fs::path& path) { return fs::exists(fs::symlink_status(path)); }
bool is_file(const fs::path& path) { return fs::is_regular_file(fs::symlink_status(path)); }
bool is_folder(const fs::path& path) { return fs::is_directory(fs::symlink_status(path)); }

}  // namespace stereotlm::files
