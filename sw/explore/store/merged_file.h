#pragma once

#include <string>

namespace stereotlm::explore {

// The new file of a merge, beside the store. It replaces the store if the merge succeeds, and is removed
// otherwise.
class MergedFile {
 public:
  // Makes the file. Removes the files of earlier merges into this store whose processes were killed. Throws
  // DatabaseError.
  explicit MergedFile(const std::string& store);
  // Removes the file unless it has replaced the store.
  ~MergedFile();
  MergedFile(const MergedFile&) = delete;
  MergedFile& operator=(const MergedFile&) = delete;

  const std::string& path() const { return path_; }

  // Replaces the store, which keeps its mode and owner (see files::take_place()). Throws DatabaseError.
  void replace(const std::string& store);

 private:
  std::string path_;
};

}  // namespace stereotlm::explore
