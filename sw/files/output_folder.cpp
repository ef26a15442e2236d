#include "sw/files/output_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <fnmatch.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <stdexcept>
#include <system_error>
#include <utility>

namespace stereotlm::files {
namespace {

namespace fs = std::filesystem;

constexpr const char* kProbe = "probe";

// Moves the entries that are there. An entry that `to` already has is an error.
void move_all(const std::vector<fs::path>& names, const fs::path& from, const fs::path& to) {
  for (const fs::path& name : names) {
    if (is_there(from / name)) rename_to_new(from / name, to / name);
  }
}

// The cause, after the name of the file that could not be moved.
std::string cause_of(const std::system_error& error) {
  const auto* const of_move = dynamic_cast<const fs::filesystem_error*>(&error);
  const bool has_name = of_move != nullptr && !of_move->path2().empty();
  return (has_name ? of_move->path2().filename().string() + ": " : "") + error.code().message();
}

}  // namespace

OutputFolder::OutputFolder(const fs::path& dir, OutputContent content)
    : dir_(dir.empty() ? dir : fs::absolute(dir)), content_(std::move(content)) {
  if (dir_.empty()) refuse("must be named");
  if (!dir_.has_filename()) dir_ = dir_.parent_path();
  // Only `run` writes into a result folder.
  if (const auto problem = result_folder_problem(content_.mark == kResultMark ? dir_ : aside()))
    refuse(*problem);
  try {
    constexpr int kMostTries = 100;
    for (int tries = 1; create_folders(), !try_lock(); ++tries) {
      if (tries == kMostTries) fail(ENOENT, aside());  // DIR takes no entries, such as /proc/self/fd
    }
    check_aside();
    repair();
    check_earlier();
    check_inputs();
    start_aside();
  } catch (const std::system_error& error) {
    discard();
    refuse("cannot be written to: " + cause_of(error));
  } catch (...) {
    discard();
    throw;
  }
}

OutputFolder::~OutputFolder() { discard(); }

void OutputFolder::create_folders() {
  std::vector<fs::path> missing;
  for (fs::path path = dir_; !is_there(path); path = path.parent_path()) missing.push_back(path);
  for (auto path = missing.rbegin(); path != missing.rend(); ++path) {
    if (fs::create_directory(*path)) created_.push_back(*path);
  }
  if (!fs::is_directory(dir_)) refuse("not a folder");
}

// Returns false if another run has removed a folder before it was locked: try again.
bool OutputFolder::try_lock() {
  if (is_there(aside()) && !is_folder(aside()))
    refuse(fmt::format("holds '{}', which is no folder", content_.aside));
  std::error_code error;
  owns_aside_ = fs::create_directory(aside(), error);
  if (error == std::errc::no_such_file_or_directory) return false;
  if (error) throw std::system_error(error);
  lock_ = open(aside().c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (lock_ < 0 && errno == ENOENT) return false;
  if (lock_ < 0) throw std::system_error(errno, std::generic_category());
  // On a file system without locks a second run is not refused.
  if (!lock_soon(lock_)) {
    owns_aside_ = false;
    refuse("in use by another run");
  }
  if (is_open_at(lock_, aside())) return true;
  close(lock_);
  lock_ = -1;
  return false;
}

bool OutputFolder::is_ours(const std::string& name) const {
  const std::size_t size = content_.prefix.size();
  return name.compare(0, size, content_.prefix) == 0 &&
         std::any_of(content_.names.begin(), content_.names.end(), [&](const std::string& pattern) {
           return fnmatch(pattern.c_str(), name.c_str() + size, FNM_EXTMATCH | FNM_PATHNAME) == 0;
         });
}

// Returns the name of a file in `entry` that the command has not written; nullopt if there is none. The entry
// is in DIR or in the folder of unfinished files.
std::optional<std::string> OutputFolder::foreign_part(const fs::path& entry) const {
  const std::string name = entry.filename();
  if (!is_folder(entry)) return is_file(entry) && is_ours(name) ? std::nullopt : std::optional(name);
  if (!is_ours(name + '/')) return name;
  for (const fs::path& inside : entries(entry)) {
    const std::string whole = name / inside;
    if (!is_file(entry / inside) || !is_ours(whole)) return whole;
  }
  return std::nullopt;
}

void OutputFolder::check_aside() const {
  for (const fs::path& name : entries(aside())) {
    if (name == kProbe && is_file(aside() / name)) continue;
    std::optional<std::string> foreign;
    const fs::path path = aside() / name;
    if ((path != made() && path != complete() && path != earlier()) || !is_folder(path)) foreign = name;
    for (const fs::path& entry : foreign ? std::vector<fs::path>() : entries(path)) {
      if (const auto part = foreign_part(path / entry)) foreign = name / *part;
    }
    if (foreign) {
      refuse(fmt::format("holds '{}', which no killed run has left there",
                         (content_.aside / fs::path(*foreign)).string()));
    }
  }
}

void OutputFolder::check_earlier() {
  const bool needs_mark = !content_.mark.empty();
  const bool has_mark =
      needs_mark && is_file(dir_ / content_.mark) && content_.kind.is_own(dir_ / content_.mark);
  for (const fs::path& name : entries(dir_)) {
    if (name == content_.aside || name == content_.kept) continue;
    const bool is_known = is_ours(name) || is_ours(name.string() + '/');
    if (!is_known && content_.others_stay) continue;
    if (const auto foreign = foreign_part(dir_ / name))
      refuse(fmt::format("holds '{}': {}", *foreign, content_.rule));
    if (!needs_mark && !content_.kind.is_own(dir_ / name))
      refuse(fmt::format("holds '{}': {}", name.string(), content_.rule));
    if (needs_mark && !has_mark) {
      refuse(fmt::format("holds '{}' but no {} that is a {}: {}", name.string(), content_.mark,
                         content_.kind.called, content_.rule));
    }
    replaced_.push_back(name);
  }
  std::stable_partition(replaced_.begin(), replaced_.end(),
                        [this](const fs::path& name) { return name == content_.mark; });
}

void OutputFolder::check_inputs() const {
  const fs::path dir = fs::canonical(dir_);
  for (const NamedFile& input : content_.inputs) {
    std::error_code missing;
    const fs::path inside = fs::canonical(input.path, missing).lexically_relative(dir);
    if (missing || inside.empty() || *inside.begin() == "..") continue;
    const fs::path entry = *inside.begin();
    if (entry == content_.aside || std::count(replaced_.begin(), replaced_.end(), entry) > 0)
      refuse(fmt::format("{} lies in it and would be replaced: an input must lie elsewhere", input.text()));
  }
}

void OutputFolder::start_aside() {
  owns_aside_ = true;
  std::vector<std::string> words = {aside()};
  words.insert(words.end(), created_.rbegin(), created_.rend());
  // As discard() does, but `earlier` is there during a commit, which the next run completes or undoes.
  remover_.emplace("[ -e \"$1\"/earlier ] || { /bin/rm -rf -- \"$1\"; shift; /bin/rmdir -- \"$@\"; }", words,
                   lock_);
  for (const fs::path& name : entries(aside())) fs::remove_all(aside() / name);
  fs::create_directory(made());
  write_whole_file(aside() / kProbe, "can this folder be written to?");
  fs::remove(aside() / kProbe);
}

NewFile& OutputFolder::new_file(const std::string& name) {
  const fs::path path = made() / name;
  if (name.empty() || name.back() == '/' || !is_ours(name) || is_there(path))
    throw std::invalid_argument(fmt::format("file = '{}': not one of the command's, or added twice", name));
  fs::create_directory(path.parent_path());
  return growing_.try_emplace(name, path).first->second;
}

template <typename Action>
void OutputFolder::store(const std::string& name, const Action& action) const {
  try {
    action();
  } catch (const std::system_error& error) {
    refuse(fmt::format("'{}' cannot be written: {}", name, error.code().message()));
  }
}

void OutputFolder::add(const std::string& name, std::string_view bytes) {
  store(name, [&] {
    NewFile& file = new_file(name);
    file.write(bytes);
    file.close();
    growing_.erase(name);
  });
}

void OutputFolder::add(const std::string& name, const std::vector<std::uint8_t>& bytes) {
  add(name, std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

void OutputFolder::append(const std::string& name, std::string_view bytes) {
  store(name, [&] {
    const auto found = growing_.find(name);
    (found == growing_.end() ? new_file(name) : found->second).write(bytes);
  });
}

void OutputFolder::commit() {
  if (committed_ || (!content_.mark.empty() && !is_file(made() / content_.mark)))
    throw std::logic_error(fmt::format("commit() may be called once, after {} is added", content_.mark));
  for (auto& [name, file] : growing_) store(name, [&file = file] { file.close(); });
  for (const fs::path& name : replaced_) {
    const auto foreign = is_there(dir_ / name) ? foreign_part(dir_ / name) : std::nullopt;
    if (foreign)
      refuse(fmt::format("has been given '{}' during the run: the result is not written", *foreign));
  }
  const std::vector<fs::path> names = with_mark_last(made());
  try {
    move_into_place(names);
  } catch (const std::system_error& error) {
    try {
      undo_commit(names);
    } catch (const std::exception& /*again*/) {
      owns_aside_ = false;  // the next run completes or undoes the commit
    }
    refuse("the new files cannot be moved into place: " + cause_of(error));
  }
  committed_ = true;
  discard();
}

std::vector<fs::path> OutputFolder::with_mark_last(const fs::path& folder) const {
  std::vector<fs::path> names = entries(folder);
  std::stable_partition(names.begin(), names.end(),
                        [this](const fs::path& name) { return name != content_.mark; });
  return names;
}

// The names of the folders in aside() show repair() how far a commit has come. Until `new` is renamed to
// `complete`, each earlier file is in DIR or in `earlier`. From then on, each new file is in DIR or in
// `complete`.
void OutputFolder::move_into_place(const std::vector<fs::path>& names) const {
  for (const fs::path& name : names) {
    if (is_folder(made() / name)) sync_folder(made() / name);
  }
  sync_folder(made());
  fs::create_directory(earlier());
  move_all(replaced_, dir_, earlier());
  fs::rename(made(), complete());
  move_all(names, complete(), dir_);
  sync_folder(dir_);
}

// Completes or undoes the commit of a killed run. May itself be interrupted and repeated.
void OutputFolder::repair() const {
  const fs::path from = is_folder(complete()) ? complete() : earlier();
  if (is_folder(from)) move_all(with_mark_last(from), from, dir_);
  // Without the folder `complete`, what is left of the earlier files would be moved back.
  fs::remove_all(earlier());
}

// Undoes a commit of these new files that has failed.
void OutputFolder::undo_commit(const std::vector<fs::path>& names) const {
  if (is_folder(complete())) {
    for (auto name = names.rbegin(); name != names.rend(); ++name) {
      if (!is_there(complete() / *name)) rename_to_new(dir_ / *name, complete() / *name);
    }
    fs::rename(complete(), made());
  }
  repair();
}

void OutputFolder::discard() noexcept {
  std::error_code ignored;
  if (owns_aside_ && !fs::remove(aside(), ignored)) {  // an empty folder is removed without a descriptor
    fs::remove_all(earlier(), ignored);                // see repair()
    fs::remove_all(aside(), ignored);
  }
  owns_aside_ = false;
  for (auto path = created_.rbegin(); path != created_.rend() && !committed_; ++path)
    fs::remove(*path, ignored);  // a folder into which the user has put something stays
  created_.clear();
  remover_.reset();
  if (lock_ >= 0) close(lock_);
  lock_ = -1;
}

void OutputFolder::refuse(const std::string& found) const {
  throw std::runtime_error(fmt::format("{} '{}': {}", content_.called, dir_.string(), found));
}

}  // namespace stereotlm::files
