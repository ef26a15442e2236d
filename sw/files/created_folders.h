#pragma once

#include <filesystem>
#include <vector>

namespace stereotlm::files {

// The folders that were missing on the way to one, for as long as it is not sure that they are to stay.
class CreatedFolders {
 public:
  CreatedFolders() = default;
  ~CreatedFolders() { remove(); }
  CreatedFolders(const CreatedFolders&) = delete;
  CreatedFolders& operator=(const CreatedFolders&) = delete;

  // Creates `dir`, an absolute path, and its parents where missing. Throws std::filesystem::filesystem_error.
  void create(const std::filesystem::path& dir);
  void keep() { created_.clear(); }
  // Those that are empty; the others stay, as the user has put something into them.
  void remove() noexcept;

 private:
  std::vector<std::filesystem::path> created_;  // outermost first
};

}  // namespace stereotlm::files
