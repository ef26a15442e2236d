#pragma once

#include <filesystem>
#include <string>

namespace stereotlm::files {

// The folder in which temporary files lie: that of the first of TMPDIR, TMP, TEMP and TEMPDIR which is set,
// or /tmp.
struct TemporaryPlace {
  std::string variable;
  std::string folder;
};
TemporaryPlace temporary_place();

// A new folder for temporary files, which goes with this object.
class TemporaryFolder {
 public:
  TemporaryFolder();  // throws std::runtime_error that names the place if there can be none
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace stereotlm::files
