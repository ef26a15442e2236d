#pragma once

#include <filesystem>
#include <string_view>

namespace stereotlm::files {

// A new file that is written piece by piece. All functions throw std::system_error with the cause as code if
// a byte cannot be stored. The caller then removes the file.
class NewFile {
 public:
  // Throws also if the file exists.
  explicit NewFile(const std::filesystem::path& path);
  ~NewFile();
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  void write(std::string_view bytes);
  // Makes the file durable, and closes it. No write() may follow.
  void close();

 private:
  [[noreturn]] void fail(int error) const;

  std::filesystem::path path_;
  int descriptor_;
};

}  // namespace stereotlm::files
