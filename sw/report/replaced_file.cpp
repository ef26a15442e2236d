#include "sw/report/replaced_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <system_error>

namespace stereotlm::report {

ReplacedFile::ReplacedFile(const std::filesystem::path& path) : path_(path) {
  for (int number = 0; file_ == nullptr; ++number) {
    aside_ = path.parent_path() / fmt::format(".stereotlm_{}_{}", getpid(), number);
    try {
      file_ = std::make_unique<NewFile>(aside_);
    } catch (const std::system_error& error) {
      if (error.code() != std::errc::file_exists) throw;
    }
  }
}

ReplacedFile::~ReplacedFile() {
  std::error_code ignored;
  if (!aside_.empty()) std::filesystem::remove(aside_, ignored);
}

void ReplacedFile::commit() {
  file_->close();
  std::filesystem::rename(aside_, path_);
  aside_.clear();
}

}  // namespace stereotlm::report
