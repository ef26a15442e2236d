#include "sw/files/whole_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <system_error>
#include <tuple>
#include <utility>

namespace stereotlm::files {
namespace {

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& cause) {
  throw std::runtime_error("'" + path.string() + "': " + cause);
}

// Makes an open file or folder durable. Returns the error; 0 if there is none, or on a file system without
// sync, which returns EINVAL or ENOTSUP.
int sync(int descriptor) { return fsync(descriptor) == 0 || errno == EINVAL || errno == ENOTSUP ? 0 : errno; }

}  // namespace

void fail(int error, const std::filesystem::path& path) {
  throw std::system_error(error, std::generic_category(), path.string());
}

NewFile::NewFile(const std::filesystem::path& path)
    : path_(path), descriptor_(open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666)) {
  if (descriptor_ < 0) fail(errno, path_);
}

NewFile::~NewFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void NewFile::write(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(descriptor_, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail(errno, path_);
    if (count == 0) fail(ENOSPC, path_);
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
}

void NewFile::close() {
  if (const int error = sync(descriptor_); error != 0) fail(error, path_);
  const int closed = ::close(descriptor_);
  descriptor_ = -1;
  if (closed != 0 && errno != EINTR) fail(errno, path_);
}

void write_whole_file(const std::filesystem::path& path, std::string_view bytes) {
  NewFile file(path);
  file.write(bytes);
  file.close();
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

void sync_folder(const std::filesystem::path& folder) {
  const int descriptor = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) fail(errno, folder);
  const int error = sync(descriptor);
  close(descriptor);
  if (error != 0) fail(error, folder);
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

TemporaryFolder::TemporaryFolder() {
  std::string variable = "TMPDIR";
  std::string folder = "/tmp";
  for (const char* name : {"TEMPDIR", "TEMP", "TMP", "TMPDIR"}) {  // the last counts
    const char* const value = std::getenv(name);
    if (value != nullptr && *value != '\0') std::tie(variable, folder) = std::pair(name, value);
  }
  const auto fail = [&](const std::string& rule) {
    throw std::runtime_error(fmt::format("{} = {}: {}", variable, folder, rule));
  };
  std::error_code error;
  if (!std::filesystem::is_directory(folder, error)) fail("must be a folder");
  std::string path = (std::filesystem::path(folder) / "stereotlm_XXXXXX").string();
  if (mkdtemp(path.data()) == nullptr)
    fail(fmt::format("must be a folder that takes temporary files: {}", std::strerror(errno)));
  path_ = path;
  // A process that is killed together with this one may still write for a moment.
  try {
    remover_.emplace("for i in 1 2 3 4 5 6 7 8 9; do /bin/rm -rf -- \"$1\" && break; sleep 0.1; done",
                     std::vector<std::string>{path});
  } catch (...) {  // such as too many open files
    rmdir(path.c_str());
    throw;
  }
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace stereotlm::files
