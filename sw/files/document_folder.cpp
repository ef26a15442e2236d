#include "sw/files/document_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <stdexcept>

#include "sw/files/folder_entries.h"

namespace stereotlm::files {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> with(std::vector<std::string> names, const std::string& name) {
  names.push_back(name);
  return names;
}

std::optional<std::string> problem_of(const fs::path& dir, const std::vector<std::string>& names,
                                      const FileKind& kind, bool was_left) {
  const std::string& document = names.back();
  const bool is_ours = was_left || (is_file(dir / document) && kind.is_own(dir / document));
  for (const std::string& name : names) {
    if (!is_there(dir / name)) continue;
    if (!is_file(dir / name)) return fmt::format("holds '{}', which is no file", name);
    if (!is_ours) {
      return fmt::format("holds '{}' but no {} that is a {}: only files of an earlier result are replaced",
                         name, document, kind.called);
    }
  }
  return std::nullopt;
}

OutputContent content_of(const std::vector<std::string>& names, const FileKind& kind,
                         const std::vector<NamedFile>& inputs) {
  OutputContent content;
  content.called = "folder";
  content.mark = names.back();
  content.foreign = [names](const fs::path& entry) -> std::optional<std::string> {
    const std::string name = entry.filename();
    const bool is_known = std::find(names.begin(), names.end(), name) != names.end();
    return is_known && is_file(entry) ? std::nullopt : std::optional(name);
  };
  content.problem = [=](const fs::path& dir, bool was_left) {
    return problem_of(dir, names, kind, was_left);
  };
  content.inputs = inputs;
  return content;
}

}  // namespace

DocumentFolder::DocumentFolder(const fs::path& dir, const std::string& document, const FileKind& kind,
                               const std::vector<std::string>& files, const std::vector<NamedFile>& inputs)
    : names_(with(files, document)), folder_(dir, content_of(names_, kind, inputs)) {}

void DocumentFolder::commit(const std::map<std::string, std::string>& contents) {
  for (const std::string& name : names_) {
    if (contents.count(name) == 0) throw std::invalid_argument(fmt::format("file = '{}': missing", name));
  }
  if (contents.size() != names_.size()) throw std::invalid_argument("files: some have other names");
  for (const auto& [name, bytes] : contents) folder_.add(name, bytes);
  folder_.commit();
}

}  // namespace stereotlm::files
