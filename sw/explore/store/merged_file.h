#pragma once

#include <string>

namespace stereotlm::explore {

// A new file beside a store, into which a merge writes; it replaces the store or is removed.
class MergedFile {
 public:
  // Makes the file. Removes such files that killed processes have left beside the same store. Throws
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
