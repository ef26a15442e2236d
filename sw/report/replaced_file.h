#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

#include "sw/report/new_file.h"

namespace stereotlm::report {

// A file that is as it was until commit(), and there whole after it. It is written aside, in the same folder,
// under a name that begins with the file's own. All throw std::system_error, whose code is the cause.
class ReplacedFile {
 public:
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

// Removes what processes have written aside for the file `path` that were killed.
void remove_left_aside(const std::filesystem::path& path) noexcept;

}  // namespace stereotlm::report
