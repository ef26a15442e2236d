#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

#include "sw/files/new_file.h"

namespace stereotlm::files {

// The path of the file that `path` leads to through symbolic links; the file need not exist. Throws
// std::system_error.
std::filesystem::path linked_file(const std::filesystem::path& path);

// Renames `made`, a whole new file, to `file`, which is in the same folder. If `file` exists, `made` gets its
// mode and owner first. Only root may give a file to another owner: otherwise `made` keeps its own owner, and
// if the group cannot be kept either, the new group may do what everybody may. Throws std::system_error.
void take_place(const std::filesystem::path& made, const std::filesystem::path& file);

// A file that is as it was until commit(), and there whole after it: see take_place(). Where the path is a
// symbolic link, the file that it leads to is replaced, and the link stays. The new file is written aside, in
// the same folder, under a name that begins with the file's own. All throw std::system_error, whose code is the
// cause.
class ReplacedFile {
 public:
  // If the file exists, it must be a regular file.
  explicit ReplacedFile(const std::filesystem::path& path);
  // Without commit(): removes what was written aside.
  ~ReplacedFile();
  ReplacedFile(const ReplacedFile&) = delete;
  ReplacedFile& operator=(const ReplacedFile&) = delete;

  void write(std::string_view bytes) { file_->write(bytes); }
  void commit();

 private:
  bool make();

  std::filesystem::path path_;
  std::filesystem::path aside_;  // empty after commit()
  std::unique_ptr<NewFile> file_;
  int lock_ = -1;  // descriptor of the file aside: locked as long as this process writes it
};

// Removes what processes that were killed have written aside for the file `path`.
void remove_left_aside(const std::filesystem::path& path) noexcept;

}  // namespace stereotlm::files
