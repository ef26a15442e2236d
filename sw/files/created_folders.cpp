#include "sw/files/created_folders.h"

#include <algorithm>
#include <system_error>

namespace stereotlm::files {

namespace fs = std::filesystem;

void CreatedFolders::create(const fs::path& dir) {
  std::vector<fs::path> missing;
  for (fs::path path = dir; fs::symlink_status(path).type() == fs::file_type::not_found;
       path = path.parent_path()) {
    missing.push_back(path);
  }
  std::reverse(missing.begin(), missing.end());
  for (const fs::path& path : missing) {
    if (fs::create_directory(path)) created_.push_back(path);
  }
}

void CreatedFolders::remove() noexcept {
  std::error_code ignored;
  for (auto path = created_.rbegin(); path != created_.rend(); ++path) fs::remove(*path, ignored);
  created_.clear();
}

}  // namespace stereotlm::files
