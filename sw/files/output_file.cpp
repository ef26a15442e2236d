#include "sw/files/output_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <fstream>
#include <stdexcept>
#include <system_error>

#include "sw/files/whole_file.h"

namespace stereotlm::files {
namespace {

namespace fs = std::filesystem;

constexpr const char* kUnfinished = "new";  // in the hidden folder

void take_owner_and_mode(const fs::path& made, const struct stat& earlier) {
  mode_t mode = earlier.st_mode & (S_IRWXU | S_IRWXG | S_IRWXO);
  const bool is_group_kept = chown(made.c_str(), earlier.st_uid, earlier.st_gid) == 0 ||
                             chown(made.c_str(), static_cast<uid_t>(-1), earlier.st_gid) == 0;
  // The group of this process gets the permissions of all other users.
  if (!is_group_kept) mode = (mode & ~static_cast<mode_t>(S_IRWXG)) | (mode & S_IRWXO) << 3U;
  if (chmod(made.c_str(), mode) != 0) fail(errno, made);
}

fs::path folder_of(const fs::path& file) { return file.has_parent_path() ? file.parent_path() : "."; }

// The hidden folder: that of "rows.csv" is ".rows.csv.writing".
fs::path aside_of(const fs::path& file) {
  // Limit for the part from the file's name: file systems limit names to 255 bytes.
  constexpr std::size_t kMostBytes = 200;
  return fs::absolute(folder_of(file)) /
         fmt::format(".{}.writing", file.filename().string().substr(0, kMostBytes));
}

// Whether both paths lead to the same file, which need not exist.
bool is_same(const fs::path& a, const fs::path& b) {
  const auto whole = [](const fs::path& path) {
    return fs::weakly_canonical(linked_file(fs::absolute(path)));
  };
  std::error_code none;
  try {
    return fs::equivalent(a, b, none) || whole(a) == whole(b);
  } catch (const std::system_error& /*error*/) {
    return false;
  }
}

// Whether the file is a run.json that `run` has written.
bool is_result(const fs::path& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return false;
  std::string head(64, '\0');
  std::ifstream(file).read(head.data(), static_cast<std::streamsize>(head.size()));
  return head.find(R"("command": "run",)") != std::string::npos;
}

}  // namespace

std::optional<std::string> result_folder_problem(const fs::path& path) {
  std::error_code error;
  fs::path inner = fs::absolute(path, error);
  if (!error) inner = fs::weakly_canonical(inner, error);
  for (; !error && inner.has_relative_path(); inner = inner.parent_path()) {
    const fs::path folder = inner.parent_path();
    if (is_result(folder / kResultMark))
      return fmt::format("the result folder '{}' of run holds nothing else: must lie elsewhere",
                         folder.string());
  }
  return std::nullopt;
}

fs::path linked_file(const fs::path& path) {
  std::error_code error;
  static_cast<void>(fs::status(path, error));  // finds links that lead round in a circle
  if (error && error != std::errc::no_such_file_or_directory && error != std::errc::not_a_directory)
    fail(error.value(), path);
  fs::path file = path;
  while (fs::is_symlink(fs::symlink_status(file, error))) file = file.parent_path() / fs::read_symlink(file);
  return file;
}

void check_is_another(const fs::path& file, const std::vector<NamedFile>& others) {
  for (const NamedFile& other : others) {
    if (!other.path.empty() && is_same(file, other.path))
      throw std::runtime_error(
          fmt::format("'{}': is the file of {}: must be another", file.string(), other.option));
  }
}

FileKind marked_kind(std::string called, std::vector<std::pair<std::size_t, std::string>> marks) {
  return {std::move(called), [marks = std::move(marks)](const fs::path& file) {
            std::ifstream stream(file, std::ios::binary);
            if (!stream) fail(errno, file);
            return std::all_of(marks.begin(), marks.end(), [&stream](const auto& mark) {
              std::string bytes(mark.second.size(), '\0');
              stream.seekg(static_cast<std::streamoff>(mark.first));
              return stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size())) &&
                     bytes == mark.second;
            });
          }};
}

void rename_to_new(const fs::path& from, const fs::path& to) {
  if (renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return;
  const bool can_do_both = errno != EINVAL && errno != ENOSYS;  // the file system
  if (can_do_both || is_there(to))
    throw fs::filesystem_error("rename", from, to, {can_do_both ? errno : EEXIST, std::generic_category()});
  fs::rename(from, to);
}

OutputFile::OutputFile(const fs::path& path, FileKind kind, const std::vector<NamedFile>& others)
    : name_(path.string()), kind_(std::move(kind)) {
  named([&] { path_ = linked_file(path); });
  check_is_another(path, others);
  if (const auto problem = result_folder_problem(path_)) refuse(*problem);
  was_there_ = check();
  const fs::path folder = folder_of(path_);
  if (faccessat(AT_FDCWD, folder.c_str(), W_OK | X_OK, AT_EACCESS) == 0) return;
  refuse(errno == ENOENT ? "there is no such folder"
                         : "cannot be written: " + std::generic_category().message(errno));
}

bool OutputFile::check() const {
  for (const std::string& ending : kind_.journals) {
    std::error_code error;
    if (fs::exists(fs::symlink_status(path_.string() + ending, error)))
      refuse(fmt::format(
          "beside it lies '{}' of an earlier database, which would mix with the new one: remove it, "
          "or give another file",
          path_.filename().string() + ending));
  }
  struct stat status = {};
  if (stat(path_.c_str(), &status) != 0) {
    if (errno == ENOENT) return false;
    refuse("cannot be written: " + std::generic_category().message(errno));
  }
  if (!S_ISREG(status.st_mode)) refuse("is no file");
  bool is_own = status.st_size == 0;
  if (!is_own) named([&] { is_own = kind_.is_own(path_); });
  if (is_own) return true;
  refuse(fmt::format(
      "exists, and is not known as a {}, which alone is replaced: move it away, or give another file",
      kind_.called));
}

void OutputFile::begin() {
  if (aside_) return;
  named([this] {
    aside_.emplace(aside_of(path_), [](const fs::path& entry) {
      const std::string name = entry.filename();  // "new", "new-journal"
      if (name.rfind(kUnfinished, 0) != 0 || !is_file(entry)) fail(EEXIST, entry);
    });
    for (const fs::path& name : entries(aside_->path())) fs::remove(aside_->path() / name);
    new_.emplace(aside_->path() / kUnfinished);
  });
}

void OutputFile::write(std::string_view bytes) {
  begin();
  named([&] { new_->write(bytes); });
}

fs::path OutputFile::unfinished() {
  begin();
  return aside_->path() / kUnfinished;
}

void OutputFile::complete() {
  begin();
  named([this] { new_ ? new_->close() : sync(unfinished()); });
  new_.reset();
}

void OutputFile::commit() {
  complete();
  check();
  named([this, from = unfinished()] {
    struct stat earlier = {};
    if (was_there_ && stat(path_.c_str(), &earlier) == 0) {
      take_owner_and_mode(from, earlier);
      fs::rename(from, path_);
    } else {
      rename_to_new(from, path_);
    }
  });
  aside_.reset();
}

// Calls `action`. Its system errors get the name of the file that the user knows.
template <typename Action>
void OutputFile::named(const Action& action) const {
  try {
    action();
  } catch (const std::system_error& error) {
    refuse("cannot be written: " + error.code().message());
  }
}

void OutputFile::refuse(const std::string& cause) const {
  throw std::runtime_error(fmt::format("'{}': {}", name_, cause));
}

}  // namespace stereotlm::files
