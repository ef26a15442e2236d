#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

#include "sw/files/new_file.h"

namespace stereotlm::files {

// Follows symbolic links from `path` to a file, which need not exist. Returns the path of that file. Throws
// std::system_error.
std::filesystem::path linked_file(const std::filesystem::path& path);

// Renames `made`, a complete new file, to `file` in the same folder. If `file` exists, `made` first gets its
// mode, owner and group. Only root may change the owner; for other users, the new file keeps the owner of
// `made`. If the group cannot be changed either, the group gets the permissions of all other users. Throws
// std::system_error.
void take_place(const std::filesystem::path& made, const std::filesystem::path& file);

// Replaces a file as a whole. The new content is first written to a hidden file in the same folder; commit()
// puts that file in place with take_place(). Until then the earlier file is unchanged. If the path is a
// symbolic link, the file to which the link leads is replaced, and the link stays. All functions throw
// std::system_error with the cause as code.
class ReplacedFile {
 public:
  // Throws also if the file exists and is no regular file.
  explicit ReplacedFile(const std::filesystem::path& path);
  // Without commit(): removes the new content.
  ~ReplacedFile();
  ReplacedFile(const ReplacedFile&) = delete;
  ReplacedFile& operator=(const ReplacedFile&) = delete;

  void write(std::string_view bytes) { file_->write(bytes); }
  // The hidden file, for a library or a program that writes the new content by its path. Empty after commit().
  const std::filesystem::path& aside() const { return aside_; }
  // Makes the new content durable. No write() may follow. Several files that belong together are all completed
  // before the first of them is committed.
  void complete();
  // Calls complete() unless that has been done.
  void commit();

 private:
  bool make();

  std::filesystem::path path_;
  std::filesystem::path aside_;    // empty after commit()
  std::unique_ptr<NewFile> file_;  // null after complete()
  int lock_ = -1;  // descriptor of the file aside, which is locked while this process writes it
};

// Removes the hidden files that killed processes have left beside the file `path`.
void remove_left_aside(const std::filesystem::path& path) noexcept;

}  // namespace stereotlm::files
