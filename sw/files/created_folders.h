#pragma once

#include <filesystem>
#include <vector>

namespace stereotlm::files {

// Creates a folder with its missing parents, and removes them again unless keep() is called. Used by
// OutputFolder.
class CreatedFolders {
 public:
  CreatedFolders() = default;
  ~CreatedFolders() { remove(); }
  CreatedFolders(const CreatedFolders&) = delete;
  CreatedFolders& operator=(const CreatedFolders&) = delete;

  // Creates `dir`, an absolute path, and its missing parents. Throws std::filesystem::filesystem_error.
  void create(const std::filesystem::path& dir);
  // The created folders stay.
  void keep() { created_.clear(); }
  // Removes the created folders that are empty. A folder into which the user has put something stays.
  void remove() noexcept;

 private:
  std::vector<std::filesystem::path> created_;  // outermost first
};

}  // namespace stereotlm::files
