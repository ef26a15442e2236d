#pragma once

#include <filesystem>

namespace stereotlm::report {

// A new folder for temporary files, which goes with this object.
class TemporaryFolder {
 public:
  TemporaryFolder();  // throws std::runtime_error if there can be none
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace stereotlm::report
