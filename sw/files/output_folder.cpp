#include "sw/files/output_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "sw/files/folder_entries.h"
#include "sw/files/output_file.h"
#include "sw/files/whole_file.h"

namespace stereotlm::files {
namespace {

namespace fs = std::filesystem;

constexpr const char* kNew = "new";
constexpr const char* kNames = "names";  // lists the new files during a commit
constexpr const char* kProbe = "probe";

// Whether the open file is the one at `path`.
bool is_same(int file, const fs::path& path) {
  struct stat opened = {};
  struct stat there = {};
  const bool is_known = fstat(file, &opened) == 0 && lstat(path.c_str(), &there) == 0;
  return is_known && opened.st_dev == there.st_dev && opened.st_ino == there.st_ino;
}

}  // namespace

OutputFolder::OutputFolder(const fs::path& dir, OutputContent content)
    : dir_(dir.empty() ? dir : fs::absolute(dir)), content_(std::move(content)) {
  if (dir_.empty()) refuse("must be named");
  if (!dir_.has_filename()) dir_ = dir_.parent_path();
  try {
    created_.create(dir_);
    if (!fs::is_directory(dir_)) refuse("not a folder");
    lock();
    check_aside();
    if (const auto found = problem()) refuse(*found);
    check_inputs();
    if (is_unfinished()) put_back();
    for (const fs::path& name : entries(dir_)) {
      if (is_replaced(dir_ / name)) replaced_.push_back(name);
    }
    start_aside();
  } catch (const std::system_error& error) {
    discard();
    refuse("cannot be written to: " + error.code().message());
  } catch (...) {
    discard();
    throw;
  }
}

OutputFolder::~OutputFolder() { discard(); }

fs::path OutputFolder::made() const { return aside() / kNew; }
fs::path OutputFolder::earlier() const { return aside() / kEarlierFolder; }

void OutputFolder::lock() {
  while (!try_lock()) {
  }
}

// Returns false if another run has removed the folder of unfinished files before it was locked: try again.
bool OutputFolder::try_lock() {
  if (is_there(aside()) && !is_folder(aside()))
    refuse(fmt::format("holds '{}', which is no folder", content_.aside));
  fs::create_directory(aside());
  lock_ = open(aside().c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (lock_ < 0 && errno == ENOENT) return false;
  if (lock_ < 0) throw std::system_error(errno, std::generic_category());
  // On a file system without locks a second run is not refused.
  if (flock(lock_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) refuse("in use by another run");
  if (is_same(lock_, aside())) return true;
  close(lock_);
  lock_ = -1;
  return false;
}

void OutputFolder::check_aside() {
  const std::vector<fs::path> left = entries(aside());
  was_left_ = !left.empty();
  owns_aside_ = !was_left_;
  const auto refuse_foreign = [this](const fs::path& found) {
    refuse(fmt::format("holds '{}', which no killed run has left there", (content_.aside / found).string()));
  };
  for (const fs::path& name : left) {
    if ((name == kProbe || name == kNames) && is_file(aside() / name)) continue;
    if ((name != kNew && name != kEarlierFolder) || !is_folder(aside() / name)) refuse_foreign(name);
    for (const fs::path& entry : entries(aside() / name)) {
      if (const auto foreign = content_.foreign(aside() / name / entry)) refuse_foreign(name / *foreign);
    }
  }
}

void OutputFolder::check_inputs() const {
  const fs::path dir = fs::canonical(dir_);
  for (const NamedFile& input : content_.inputs) {
    std::error_code missing;
    const fs::path inside = fs::canonical(input.path, missing).lexically_relative(dir);
    if (missing || inside.empty() || *inside.begin() == "..") continue;
    const fs::path entry = *inside.begin();
    if (entry == content_.aside || is_replaced(dir_ / entry))
      refuse(fmt::format("{} lies in it and would be replaced: an input must lie elsewhere", input.text()));
  }
}

void OutputFolder::start_aside() {
  for (const fs::path& name : entries(aside())) fs::remove_all(aside() / name);
  owns_aside_ = true;
  fs::create_directory(made());
  write_whole_file(aside() / kProbe, "can this folder be written to?");
  fs::remove(aside() / kProbe);
}

void OutputFolder::add(const std::string& name, std::string_view bytes) {
  const fs::path path = made() / name;
  try {
    fs::create_directory(path.parent_path());
    write_whole_file(path, bytes);
  } catch (const std::system_error& error) {
    refuse_file(name, error.code());
  }
}

void OutputFolder::append(const std::string& name, std::string_view bytes) {
  try {
    growing_.try_emplace(name, made() / name).first->second.write(bytes);
  } catch (const std::system_error& error) {
    refuse_file(name, error.code());
  }
}

void OutputFolder::refuse_file(const std::string& name, const std::error_code& cause) const {
  std::error_code ignored;
  fs::remove(made() / name, ignored);
  refuse(fmt::format("'{}' cannot be written: {}", name, cause.message()));
}

void OutputFolder::commit() {
  if (committed_ || (!content_.mark.empty() && !is_file(made() / content_.mark)))
    throw std::logic_error(fmt::format("commit() may be called once, after {} is added", content_.mark));
  for (auto& [name, file] : growing_) {
    try {
      file.close();
    } catch (const std::system_error& error) {
      refuse_file(name, error.code());
    }
  }
  try {
    move_into_place();
  } catch (const std::system_error& error) {
    try {
      // If the new mark stayed in place, the next run would take the commit for complete.
      if (!content_.mark.empty() && !is_there(made() / content_.mark))
        fs::rename(dir_ / content_.mark, made() / content_.mark);
      put_back();
    } catch (const std::exception& /*again*/) {
      owns_aside_ = false;  // the next run restores the files that are left there
    }
    const auto* const of_move = dynamic_cast<const fs::filesystem_error*>(&error);
    refuse(fmt::format("the new files cannot be moved into place: {}{}",
                       of_move == nullptr ? "" : of_move->path2().filename().string() + ": ",
                       error.code().message()));
  }
  committed_ = true;
  discard();
}

// put_back() relies on the order of the moves. The earlier mark is moved away last: while it is in place, all
// other files in place are earlier ones. The new mark is moved in last: once it is in place, all files are
// new.
void OutputFolder::move_into_place() const {
  const std::vector<fs::path> names = entries(made());
  const auto move_all = [this](const std::vector<fs::path>& all, const fs::path& from, const fs::path& to) {
    const auto move = [&](const fs::path& name) {
      if (is_there(from / name)) rename_to_new(from / name, to / name);
    };
    for (const fs::path& name : all) {
      if (name != content_.mark) move(name);
    }
    if (std::find(all.begin(), all.end(), content_.mark) != all.end()) move(content_.mark);
  };
  std::string text;
  for (const fs::path& name : names) {
    if (is_folder(made() / name)) sync_folder(made() / name);
    text += name.string() + '\0';
  }
  write_whole_file(aside() / kNames, text);
  fs::create_directory(earlier());
  move_all(replaced_, dir_, earlier());
  move_all(names, made(), dir_);
  sync_folder(dir_);
}

// The names of the files that an unfinished commit, possibly of another run, was moving into place. Empty if
// the commit was already undone and the run was killed while it removed its files.
std::vector<fs::path> OutputFolder::moved_names() const {
  std::vector<fs::path> names;
  if (!is_file(aside() / kNames)) return names;
  std::istringstream text(read_whole_file(aside() / kNames));
  for (std::string name; std::getline(text, name, '\0');) {
    if (fs::path(name).filename() == name && !content_.foreign(dir_ / name)) names.emplace_back(name);
  }
  return names;
}

// Whether a run was killed, or has failed, while it moved files into place.
bool OutputFolder::is_unfinished() const {
  if (!is_folder(made())) return false;
  return content_.mark.empty() ? !entries(made()).empty() : is_file(made() / content_.mark);
}

// Undoes an unfinished commit, wherever it stopped. May itself be interrupted and repeated.
void OutputFolder::put_back() const {
  if (!is_folder(earlier())) return;
  if (!is_file(dir_ / content_.mark)) {
    for (const fs::path& name : moved_names()) {
      if (is_there(dir_ / name) && !is_there(made() / name)) fs::rename(dir_ / name, made() / name);
    }
    if (is_file(earlier() / content_.mark)) fs::rename(earlier() / content_.mark, dir_ / content_.mark);
  }
  for (const fs::path& name : entries(earlier())) fs::rename(earlier() / name, dir_ / name);
}

void OutputFolder::discard() noexcept {
  std::error_code ignored;
  if (owns_aside_) fs::remove_all(aside(), ignored);
  owns_aside_ = false;
  if (committed_) created_.keep();
  created_.remove();
  if (lock_ >= 0) close(lock_);
  lock_ = -1;
}

void OutputFolder::refuse(const std::string& found) const {
  throw std::runtime_error(fmt::format("{} '{}': {}", content_.called, dir_.string(), found));
}

}  // namespace stereotlm::files
