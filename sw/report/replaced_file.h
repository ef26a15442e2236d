#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

#include "sw/report/new_file.h"

namespace stereotlm::report {

// A file that is as it was until commit(), and there whole after it. It is written aside, in the same folder,
// under a name that nothing has there. All throw std::system_error, whose code is the cause.
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
  std::filesystem::path path_;
  std::filesystem::path aside_;  // empty after commit()
  std::unique_ptr<NewFile> file_;
};

}  // namespace stereotlm::report
