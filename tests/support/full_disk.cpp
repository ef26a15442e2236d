// A library for LD_PRELOAD that turns the folder FULL_DISK_FOLDER into a disk of FULL_DISK_BYTES: a write
// fails with ENOSPC if all files together would need more bytes.

#include <dlfcn.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <system_error>

namespace {

// The size of all files in a folder.
off_t bytes_in(const std::string& folder) {
  off_t bytes = 0;
  std::error_code none;
  for (auto entry = std::filesystem::recursive_directory_iterator(folder, none); !none && entry != end(entry);
       entry.increment(none)) {
    struct stat status = {};
    if (stat(entry->path().c_str(), &status) == 0 && S_ISREG(status.st_mode)) bytes += status.st_size;
  }
  return bytes;
}

// Whether the file may grow to this length; sets errno if not.
bool has_room(int file, off_t length) {
  const char* const folder = std::getenv("FULL_DISK_FOLDER");
  const char* const most = std::getenv("FULL_DISK_BYTES");
  struct stat status = {};
  if (folder == nullptr || most == nullptr || fstat(file, &status) != 0 || length <= status.st_size)
    return true;
  std::array<char, 4096> path{};
  const std::string link = "/proc/self/fd/" + std::to_string(file);
  if (readlink(link.c_str(), path.data(), path.size() - 1) <= 0) return true;
  const std::string begin = std::string(folder) + '/';
  if (std::strncmp(path.data(), begin.c_str(), begin.size()) != 0) return true;
  if (bytes_in(folder) + length - status.st_size <= std::atoll(most)) return true;
  errno = ENOSPC;
  return false;
}

template <typename Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" {

ssize_t write(int file, const void* bytes, size_t count) {
  static auto* const real = next<ssize_t(int, const void*, size_t)>("write");
  const off_t place = lseek(file, 0, SEEK_CUR);
  if (place >= 0 && !has_room(file, place + static_cast<off_t>(count))) return -1;
  return real(file, bytes, count);
}

ssize_t pwrite(int file, const void* bytes, size_t count, off_t place) {
  static auto* const real = next<ssize_t(int, const void*, size_t, off_t)>("pwrite");
  return has_room(file, place + static_cast<off_t>(count)) ? real(file, bytes, count, place) : -1;
}

ssize_t pwrite64(int file, const void* bytes, size_t count, off64_t place) {
  return pwrite(file, bytes, count, place);
}

int ftruncate(int file, off_t length) noexcept {
  static auto* const real = next<int(int, off_t)>("ftruncate");
  return has_room(file, length) ? real(file, length) : -1;
}

int ftruncate64(int file, off64_t length) noexcept { return ftruncate(file, length); }

}  // extern "C"
