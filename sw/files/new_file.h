#pragma once

#include <filesystem>
#include <string_view>

namespace stereotlm::files {

// A new file, written piece by piece. All throw std::system_error, whose code is the cause, if a byte could
// not be stored: what is left of the file is then the caller's to remove.
class NewFile {
 public:
  // An existing file is an error.
  explicit NewFile(const std::filesystem::path& path);
  ~NewFile();
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  void write(std::string_view bytes);
  // Makes it durable.
  void close();

 private:
  [[noreturn]] void fail(int error) const;

  std::filesystem::path path_;
  int descriptor_;
};

}  // namespace stereotlm::files
