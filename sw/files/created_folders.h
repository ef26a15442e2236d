#pragma once

#include <filesystem>
#include <vector>

namespace stereotlm::files {

// The missing parents that were created for a folder, until it is certain that they stay.
class CreatedFolders {
 public:
  CreatedFolders() = default;
  ~CreatedFolders() { remove(); }
  CreatedFolders(const CreatedFolders&) = delete;
  CreatedFolders& operator=(const CreatedFolders&) = delete;

  // Creates `dir`, an absolute path, and its missing parents. Throws std::filesystem::filesystem_error.
  void create(const std::filesystem::path& dir);
  void keep() { created_.clear(); }
  // Removes the created folders that are empty. The user has put something into the others: they stay.
  void remove() noexcept;

 private:
  std::vector<std::filesystem::path> created_;  // outermost first
};

}  // namespace stereotlm::files
