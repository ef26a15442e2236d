#include "sw/files/whole_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <system_error>

namespace stereotlm::files {
namespace {

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& cause) {
  throw std::runtime_error("'" + path.string() + "': " + cause);
}

}  // namespace

void fail(int error, const std::filesystem::path& path) {
  throw std::system_error(error, std::generic_category(), path.string());
}

void check_regular_file(const std::filesystem::path& path) {
  namespace fs = std::filesystem;
  std::error_code error;
  const auto status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found) refuse(path, "no such file");
  if (error) refuse(path, error.message());
  if (!fs::is_regular_file(status)) refuse(path, "must be a regular file");
}

std::string read_whole_file(const std::filesystem::path& path, std::uintmax_t most_bytes) {
  check_regular_file(path);
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(path, error);
  if (error) refuse(path, error.message());
  if (bytes > most_bytes) refuse(path, fmt::format("{} bytes: must be {} at most", bytes, most_bytes));
  std::ifstream file(path, std::ios::binary);
  std::string content(bytes, '\0');
  file.read(content.data(), static_cast<std::streamsize>(bytes));
  if (!file.is_open() || file.bad()) refuse(path, std::strerror(errno));
  content.resize(static_cast<std::size_t>(file.gcount()));
  return content;
}

void sync(const std::filesystem::path& path) {
  const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) fail(errno, path);
  const int error = fsync(descriptor) == 0 ? 0 : errno;
  close(descriptor);
  if (error != 0 && error != EINVAL && error != ENOTSUP) fail(error, path);
}

std::vector<std::filesystem::path> entries(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> names(std::filesystem::directory_iterator(folder),
                                           std::filesystem::directory_iterator{});
  for (std::filesystem::path& name : names) name = name.filename();
  std::sort(names.begin(), names.end());
  return names;
}

bool is_open_at(int file, const std::filesystem::path& path) {
  struct stat opened = {};
  struct stat there = {};
  const bool is_known = fstat(file, &opened) == 0 && lstat(path.c_str(), &there) == 0;
  return is_known && opened.st_dev == there.st_dev && opened.st_ino == there.st_ino;
}

bool is_there(const std::filesystem::path& path) {
  return std::filesystem::exists(std::filesystem::symlink_status(path));
}
bool is_file(const std::filesystem::path& path) {
  return std::filesystem::is_regular_file(std::filesystem::symlink_status(path));
}
bool is_folder(const std::filesystem::path& path) {
  return std::filesystem::is_directory(std::filesystem::symlink_status(path));
}

}  // namespace stereotlm::files
