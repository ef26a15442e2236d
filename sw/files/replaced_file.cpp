#include "sw/files/replaced_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <exception>
#include <random>
#include <string>
#include <system_error>
#include <vector>

namespace stereotlm::files {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(int error, const fs::path& path) {
  throw std::system_error(error, std::generic_category(), path.string());
}

void take_owner_and_mode(const fs::path& made, const struct stat& earlier) {
  constexpr mode_t kPermissions = 07777;
  const bool is_owner_kept = chown(made.c_str(), earlier.st_uid, earlier.st_gid) == 0;
  const bool is_group_kept =
      is_owner_kept || chown(made.c_str(), static_cast<uid_t>(-1), earlier.st_gid) == 0;
  mode_t mode = earlier.st_mode & kPermissions;
  if (!is_owner_kept) mode &= ~static_cast<mode_t>(S_ISUID | S_ISGID);
  if (!is_group_kept) mode = (mode & ~static_cast<mode_t>(S_IRWXG)) | (mode & S_IRWXO) << 3U;
  if (chmod(made.c_str(), mode) != 0) fail(errno, made);
}

// The hidden file for "rows.csv" is ".rows.csv.writing-" and this number of random hexadecimal digits.
constexpr std::size_t kDigits = 16;

// The name of the hidden file without its digits.
std::string beginning(const fs::path& path) {
  // Limit for the part from the file's name: file systems limit names to 255 bytes.
  constexpr std::size_t kMostBytes = 200;
  return fmt::format(".{}.writing-", path.filename().string().substr(0, kMostBytes));
}

fs::path folder_of(const fs::path& path) { return path.has_parent_path() ? path.parent_path() : "."; }

// Removes a hidden file if no process has locked it, and hence none is writing it. On a file system without
// locks the file stays.
void remove_if_left(const fs::path& aside) {
  const int file = open(aside.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (file < 0) return;
  if (flock(file, LOCK_EX | LOCK_NB) == 0) unlink(aside.c_str());
  close(file);
}

}  // namespace

fs::path linked_file(const fs::path& path) {
  constexpr int kMostLinks = 40;  // the system's limit
  fs::path file = path;
  std::error_code error;
  for (int links = 0; fs::is_symlink(fs::symlink_status(file, error)); ++links) {
    if (links == kMostLinks) fail(ELOOP, path);
    file = file.parent_path() / fs::read_symlink(file);
  }
  if (error && error != std::errc::no_such_file_or_directory && error != std::errc::not_a_directory)
    fail(error.value(), path);
  return file;
}

void take_place(const fs::path& made, const fs::path& file) {
  struct stat earlier = {};
  if (stat(file.c_str(), &earlier) == 0) take_owner_and_mode(made, earlier);
  fs::rename(made, file);
}

ReplacedFile::ReplacedFile(const fs::path& path) : path_(linked_file(path)) {
  const fs::file_status status = fs::status(path_);
  if (fs::exists(status) && !fs::is_regular_file(status))
    fail(fs::is_directory(status) ? EISDIR : ENOTSUP, path);
  while (!make()) {
  }
}

// Creates and locks the hidden file. Returns false if its name is taken, or if another process has removed
// the file before it was locked.
bool ReplacedFile::make() {
  std::random_device random;
  aside_ = folder_of(path_) / fmt::format("{}{:08x}{:08x}", beginning(path_), random(), random());
  try {
    file_ = std::make_unique<NewFile>(aside_);
  } catch (const std::system_error& error) {
    if (error.code() != std::errc::file_exists) throw;
    return false;
  }
  lock_ = open(aside_.c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC);
  if (lock_ < 0 && errno == ENOENT) return false;
  if (lock_ < 0) {
    const int error = errno;
    unlink(aside_.c_str());
    fail(error, aside_);
  }
  flock(lock_, LOCK_EX);
  struct stat status = {};
  if (fstat(lock_, &status) == 0 && status.st_nlink > 0) return true;
  close(lock_);
  return false;
}

ReplacedFile::~ReplacedFile() {
  std::error_code ignored;
  if (!aside_.empty()) fs::remove(aside_, ignored);
  if (lock_ >= 0) close(lock_);
}

void ReplacedFile::complete() {
  file_->close();
  file_.reset();
}

void ReplacedFile::commit() {
  if (file_) complete();
  take_place(aside_, path_);
  aside_.clear();
}

void remove_left_aside(const fs::path& path) noexcept try {
  const fs::path file = linked_file(path);
  const std::string begin = beginning(file);
  std::error_code ignored;
  std::vector<fs::path> left;
  for (fs::directory_iterator entry(folder_of(file), ignored), end; !ignored && entry != end;
       entry.increment(ignored)) {
    const std::string name = entry->path().filename();
    const bool is_ours = name.size() == begin.size() + kDigits && name.rfind(begin, 0) == 0 &&
                         name.find_first_not_of("0123456789abcdef", begin.size()) == std::string::npos;
    if (is_ours) left.push_back(entry->path());
  }
  for (const fs::path& aside : left) remove_if_left(aside);
} catch (const std::exception& /*a path that cannot be followed*/) {
  // The caller reports the error when it writes the file.
}

}  // namespace stereotlm::files
