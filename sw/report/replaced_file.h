#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

#include "sw/report/new_file.h"

namespace stereotlm::report {

// The file that a path names, behind all symbolic links; it may be none yet. Throws std::system_error.
std::filesystem::path linked_file(const std::filesystem::path& path);

// Gives a whole new file the name of another in its folder, and that one's mode and owner if it is there. Where
// the system does not let a file be given away it keeps its own owner, and no group may do more than all may.
// Throws std::system_error.
void take_place(const std::filesystem::path& made, const std::filesystem::path& file);

// A file that is as it was until commit(), and there whole after it, with the mode and owner that it had. Behind
// a symbolic link it is the file that is replaced, not the link. It is written aside, in the same folder, under
// a name that begins with the file's own. All throw std::system_error, whose code is the cause.
class ReplacedFile {
 public:
  // What is there must be a regular file.
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

// Removes what processes that were killed have written aside for the file `path`. Throws std::system_error if
// its links go round in circles.
void remove_left_aside(const std::filesystem::path& path);

}  // namespace stereotlm::report
