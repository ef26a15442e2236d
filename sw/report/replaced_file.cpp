#include "sw/report/replaced_file.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace stereotlm::report {
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

}  // namespace

fs::path linked_file(const fs::path& path) {
  constexpr int kMostLinks = 40;  // as the system
  fs::path file = path;
  for (int links = 0; fs::is_symlink(fs::symlink_status(file)); ++links) {
    if (links == kMostLinks) fail(ELOOP, path);
    file = file.parent_path() / fs::read_symlink(file);
  }
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
  for (int number = 0; file_ == nullptr; ++number) {
    aside_ = path_.parent_path() / fmt::format(".stereotlm_{}_{}", getpid(), number);
    try {
      file_ = std::make_unique<NewFile>(aside_);
    } catch (const std::system_error& error) {
      if (error.code() != std::errc::file_exists) throw;
    }
  }
}

ReplacedFile::~ReplacedFile() {
  std::error_code ignored;
  if (!aside_.empty()) std::filesystem::remove(aside_, ignored);
}

void ReplacedFile::commit() {
  file_->close();
  take_place(aside_, path_);
  aside_.clear();
}

}  // namespace stereotlm::report
