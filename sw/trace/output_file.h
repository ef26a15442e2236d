#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "sw/files/replaced_file.h"

namespace stereotlm::trace {

// A ReplacedFile with a buffer in front of it. All functions throw std::runtime_error with the path and the
// cause.
class OutputFile {
 public:
  explicit OutputFile(const std::filesystem::path& path);

  void write(std::string_view bytes) {
    if (bytes.size() >= kBufferBytes) return write_through(bytes);
    buffer_.append(bytes);
    if (buffer_.size() >= kBufferBytes) flush();
  }
  // A library or a program may write the content to this path instead of calling write().
  const std::filesystem::path& aside() const { return file_.aside(); }
  // Makes the content durable. Nothing may be written after it.
  void complete();
  // To be called after complete().
  void commit();

 private:
  static constexpr std::size_t kBufferBytes = std::size_t{1} << 18U;
  void flush();
  void write_through(std::string_view bytes);

  std::filesystem::path path_;
  files::ReplacedFile file_;
  std::string buffer_;
};

}  // namespace stereotlm::trace
