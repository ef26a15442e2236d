#include "sw/files/output_folder.h"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "sw/files/whole_file.h"

namespace stereotlm::files {
namespace {

namespace fs = std::filesystem;

bool is_no_folder(fs::file_type type) {
  return type != fs::file_type::not_found && type != fs::file_type::directory;
}

// Moves the entries that are there. An entry that `to` already has is an error.
void move_all(const std::vector<fs::path>& names, const fs::path& from, const fs::path& to) {
  for (const fs::path& name : names) {
    if (is_there(from / name)) rename_to_new(from / name, to / name);
  }
}

}  // namespace

OutputFolder::OutputFolder(const fs::path& dir, OutputContent content)
    : dir_(dir.empty() ? dir : fs::absolute(dir)), content_(std::move(content)) {
  if (dir_.empty()) refuse("must be named");
  if (!dir_.has_filename()) dir_ = dir_.parent_path();
  // Only `run` writes into a result folder.
  if (const auto problem = result_folder_problem(content_.mark == kResultMark ? dir_ : aside()))
    refuse(*problem);
  attempt("cannot be written to", [this] {
    // One look at each: meanwhile the Remover of a killed process may remove them.
    const fs::file_type at_dir = fs::symlink_status(dir_).type();
    if (at_dir == fs::file_type::symlink ? !fs::is_directory(dir_) : is_no_folder(at_dir))
      refuse("not a folder");
    if (is_no_folder(fs::symlink_status(aside()).type()))
      refuse(fmt::format("holds '{}', which is no folder", aside().filename().string()));
    aside_.emplace(aside(), [this](const fs::path& entry) {
      if (entry != made() && entry != complete() && entry != earlier()) {
        refuse(fmt::format("holds '{}', which no killed run has left there",
                           entry.lexically_relative(dir_).string()));
      }
    });
    repair();
    check_earlier();
    check_inputs();
    for (const fs::path& name : entries(aside())) fs::remove_all(aside() / name);
    write_whole_file(made(), "can this folder be written to?");
    fs::remove(made());
    fs::create_directory(made());
  });
}

bool OutputFolder::is_ours(const std::string& name) const {
  const std::size_t size = content_.prefix.size();
  return name.compare(0, size, content_.prefix) == 0 &&
         std::any_of(content_.names.begin(), content_.names.end(), [&](const std::string& pattern) {
           return fnmatch(pattern.c_str(), name.c_str() + size, FNM_EXTMATCH | FNM_PATHNAME) == 0;
         });
}

// Returns the name of a file in `entry`, of DIR, that the command has not written; nullopt if there is none.
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

void OutputFolder::check_earlier() {
  const auto is_own = [this](const fs::path& file) { return is_file(file) && content_.kind.is_own(file); };
  const bool has_mark = content_.mark.empty() || is_own(dir_ / content_.mark);
  for (const fs::path& name : entries(dir_)) {
    if (name == aside().filename()) continue;
    const bool is_known = is_ours(name) || is_ours(name.string() + '/');
    if (!is_known && content_.others_stay) continue;
    auto found = foreign_part(dir_ / name);
    if (!found && content_.mark.empty() && !is_own(dir_ / name)) found = name;
    if (found) refuse(fmt::format("holds '{}': {}", *found, content_.rule));
    if (!has_mark) {
      refuse(fmt::format("holds '{}' but no {} that is a {}: {}", name.string(), content_.mark,
                         content_.kind.called, content_.rule));
    }
    replaced_.insert(name == content_.mark ? replaced_.begin() : replaced_.end(), name);
  }
}

void OutputFolder::check_inputs() const {
  const fs::path dir = fs::canonical(dir_);
  for (const NamedFile& input : content_.inputs) {
    std::error_code missing;
    const fs::path inside = fs::canonical(input.path, missing).lexically_relative(dir);
    if (missing || inside.empty() || *inside.begin() == "..") continue;
    const fs::path entry = *inside.begin();
    if (entry == aside().filename() || std::count(replaced_.begin(), replaced_.end(), entry) > 0)
      refuse(fmt::format("{} lies in it and would be replaced: an input must lie elsewhere", input.text()));
  }
}

NewFile& OutputFolder::new_file(const std::string& name) {
  const fs::path path = made() / name;
  if (name.empty() || name.back() == '/' || !is_ours(name) || is_there(path))
    throw std::invalid_argument(fmt::format("file = '{}': not one of the command's, or added twice", name));
  fs::create_directory(path.parent_path());
  return growing_.try_emplace(name, path).first->second;
}

void OutputFolder::add(const std::string& name, std::string_view bytes) {
  attempt(fmt::format("'{}' cannot be written", name), [&] {
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
  attempt(fmt::format("'{}' cannot be written", name), [&] {
    const auto found = growing_.find(name);
    (found == growing_.end() ? new_file(name) : found->second).write(bytes);
  });
}

// The names of the folders in aside() show repair() how far a commit has come. Until `new` is renamed to
// `complete`, each earlier file is in DIR or in `earlier`. From then on, each new file is in DIR or in
// `complete`. `earlier` exists until the commit is done or undone; the files that were replaced end with it.
void OutputFolder::commit() {
  if (!aside_ || (!content_.mark.empty() && !is_file(made() / content_.mark)))
    throw std::logic_error(fmt::format("commit() may be called once, after {} is added", content_.mark));
  for (auto& [name, file] : growing_)
    attempt(fmt::format("'{}' cannot be written", name), [&file = file] { file.close(); });
  for (const fs::path& name : replaced_) {
    const auto foreign = is_there(dir_ / name) ? foreign_part(dir_ / name) : std::nullopt;
    if (foreign)
      refuse(fmt::format("has been given '{}' during the run: the result is not written", *foreign));
  }
  const std::vector<fs::path> names = with_mark_last(made());
  attempt("the new files cannot be moved into place", [&] {
    for (const fs::path& name : names) {
      if (is_folder(made() / name)) sync(made() / name);
    }
    sync(made());
    fs::create_directory(earlier());
    try {
      move_all(replaced_, dir_, earlier());
      fs::rename(made(), complete());
      move_all(names, complete(), dir_);
      sync(dir_);
    } catch (const std::system_error&) {
      undo(names);
      throw;
    }
  });
  std::error_code ignored;
  fs::remove_all(earlier(), ignored);
  aside_.reset();
}

// The entries of a folder. The mark comes last.
std::vector<fs::path> OutputFolder::with_mark_last(const fs::path& folder) const {
  std::vector<fs::path> names = entries(folder);
  std::stable_partition(names.begin(), names.end(),
                        [this](const fs::path& name) { return name != content_.mark; });
  return names;
}

// Completes or undoes the commit of a killed run. May itself be interrupted and repeated.
void OutputFolder::repair() const {
  const fs::path from = is_folder(complete()) ? complete() : earlier();
  if (is_folder(from)) move_all(with_mark_last(from), from, dir_);
  fs::remove_all(earlier());
}

// Undoes a commit of these new files that has failed. If that fails too, the next run completes or undoes it.
void OutputFolder::undo(const std::vector<fs::path>& names) const try {
  if (is_folder(complete())) {
    for (auto name = names.rbegin(); name != names.rend(); ++name) {
      if (!is_there(complete() / *name)) rename_to_new(dir_ / *name, complete() / *name);
    }
    fs::rename(complete(), made());
  }
  repair();
} catch (const std::exception& /*again*/) {
}

// Calls `action`. If a call of the system fails in it, refuses with the problem, the file that could not be
// moved, and the cause.
template <typename Action>
void OutputFolder::attempt(const std::string& problem, const Action& action) const {
  try {
    action();
  } catch (const std::system_error& error) {
    if (!aside_ && error.code() == std::errc::device_or_resource_busy) refuse("in use by another run");
    const auto* const of_move = dynamic_cast<const fs::filesystem_error*>(&error);
    const bool has_name = of_move != nullptr && !of_move->path2().empty();
    refuse(fmt::format("{}: {}{}", problem, has_name ? of_move->path2().filename().string() + ": " : "",
                       error.code().message()));
  }
}

void OutputFolder::refuse(const std::string& found) const {
  throw std::runtime_error(fmt::format("{} '{}': {}", content_.called, dir_.string(), found));
}

}  // namespace stereotlm::files
