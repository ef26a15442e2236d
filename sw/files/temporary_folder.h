#pragma once

#include <filesystem>
#include <string>

namespace stereotlm::files {

// Where temporary files go: the first of the environment variables TMPDIR, TMP, TEMP and TEMPDIR that is set,
// and its value; if none is set, TMPDIR and /tmp.
struct TemporaryPlace {
  std::string variable;
  std::string folder;
};
TemporaryPlace temporary_place();

// A new folder for temporary files. The destructor removes it.
class TemporaryFolder {
 public:
  TemporaryFolder();  // throws std::runtime_error with the place if it cannot be created
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace stereotlm::files
