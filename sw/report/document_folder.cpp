#include "sw/report/document_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <system_error>

#include "sw/report/whole_file.h"

namespace stereotlm::report {
namespace {

namespace fs = std::filesystem;

constexpr const char* kAside = ".partial";
constexpr const char* kProbe = "probe";

bool is_there(const fs::path& path) { return fs::exists(fs::symlink_status(path)); }
bool is_file(const fs::path& path) { return fs::is_regular_file(fs::symlink_status(path)); }

}  // namespace

DocumentFolder::DocumentFolder(const fs::path& dir, const std::string& document,
                               const std::vector<std::string>& files)
    : dir_(dir.empty() ? dir : fs::absolute(dir)), document_(document), names_(files) {
  names_.push_back(document);
  if (dir_.empty()) throw std::runtime_error("folder '': must be named");
  if (!dir_.has_filename()) dir_ = dir_.parent_path();
  try {
    created_.create(dir_);
    if (!fs::is_directory(dir_)) refuse("not a folder");
    check_content();
    const fs::path aside = dir_ / kAside;
    fs::remove_all(aside);
    fs::create_directory(aside);
    owns_aside_ = true;
    write_whole_file(aside / kProbe, "can this folder be written to?");
    fs::remove(aside / kProbe);
  } catch (const std::system_error& error) {
    discard();
    refuse("cannot be written to: " + error.code().message());
  } catch (...) {
    discard();
    throw;
  }
}

DocumentFolder::~DocumentFolder() { discard(); }

void DocumentFolder::check_content() const {
  const bool is_ours = is_file(dir_ / document_);
  for (const std::string& name : names_) {
    if (!is_there(dir_ / name)) continue;
    if (!is_file(dir_ / name)) refuse(fmt::format("holds '{}', which is no file", name));
    if (!is_ours) {
      refuse(fmt::format("holds '{}' but no {}: only what an earlier one has written is replaced", name,
                         document_));
    }
  }
  const fs::path aside = dir_ / kAside;
  if (!is_there(aside)) return;
  if (!fs::is_directory(fs::symlink_status(aside)))
    refuse(fmt::format("holds '{}', which is no folder", kAside));
  for (const auto& entry : fs::directory_iterator(aside)) {
    const std::string name = entry.path().filename();
    const bool is_known = name == kProbe || std::find(names_.begin(), names_.end(), name) != names_.end();
    if (!is_known || !is_file(entry.path())) {
      refuse(fmt::format("holds '{}/{}': no killed run has left that there", kAside, name));
    }
  }
}

void DocumentFolder::commit(const std::map<std::string, std::string>& contents) {
  for (const std::string& name : names_) {
    if (contents.count(name) == 0) throw std::invalid_argument(fmt::format("file = '{}': missing", name));
  }
  if (contents.size() != names_.size()) throw std::invalid_argument("files: there are some of other names");
  try {
    for (const std::string& name : names_) write_whole_file(dir_ / kAside / name, contents.at(name));
    for (const std::string& name : names_) fs::rename(dir_ / kAside / name, dir_ / name);
    sync_folder(dir_);
  } catch (const std::system_error& error) {
    refuse("the files cannot be written: " + error.code().message());
  }
  created_.keep();
  discard();
}

void DocumentFolder::discard() noexcept {
  std::error_code ignored;
  if (owns_aside_) fs::remove_all(dir_ / kAside, ignored);
  owns_aside_ = false;
  created_.remove();
}

void DocumentFolder::refuse(const std::string& found) const {
  throw std::runtime_error(fmt::format("folder '{}': {}", dir_.string(), found));
}

}  // namespace stereotlm::report
