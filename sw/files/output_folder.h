#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sw/files/output_file.h"

namespace stereotlm::files {

// Describes the files that a command writes into a folder, DIR.
struct OutputContent {
  std::string called;  // name of DIR in messages: "result folder"
  // The file that is removed first and moved into place last: if it exists, all files are complete. Empty: no
  // file is the mark.
  std::string mark;
  FileKind kind;     // of the mark; without mark, of each file that is replaced
  std::string rule;  // completes messages about files that must not be replaced: "must be empty or .."
  // The names of the files that the command writes in DIR, behind the prefix, as patterns for fnmatch() with
  // FNM_EXTMATCH: "stats.json", "frames/+([0-9]).png". The name of a folder ends in a slash.
  std::vector<std::string> names;
  std::string prefix = {};
  bool others_stay = false;            // DIR may hold other files too, which stay
  std::vector<NamedFile> inputs = {};  // files that the command reads
};

// The output folder of a command. commit() replaces its files all together. New files are written to
// DIR/PREFIX.partial (inside DIR, so that DIR may be a mount point).
class OutputFolder {
 public:
  // Makes DIR and its missing parents. Completes or undoes the commit of a killed run. Throws
  // std::runtime_error, without other changes, if DIR is not writable or in use, lies in a result folder of
  // `run` or is one of another command, if an input would be replaced, or if files are there that the command
  // does not write (see OutputContent::others_stay) or that OutputContent::kind does not accept.
  OutputFolder(const std::filesystem::path& dir, OutputContent content);
  const std::filesystem::path& path() const { return dir_; }  // DIR, absolute

  // Adds a file of the command, each name once. Throws std::invalid_argument for another name, and
  // std::runtime_error if the file cannot be stored (disk full). The object can then only be destroyed.
  void add(const std::string& name, std::string_view bytes);
  void add(const std::string& name, const std::vector<std::uint8_t>& bytes);
  // Adds bytes to the end of a file that only append() writes. Throws as add() does.
  void append(const std::string& name, std::string_view bytes);
  // Moves all files into place. Throws std::logic_error if the mark was not added or commit() was called
  // before. If it fails, restores all files and throws std::runtime_error.
  void commit();

 private:
  using Path = std::filesystem::path;
  Path aside() const { return dir_ / (content_.prefix + ".partial"); }
  Path made() const { return aside() / "new"; }
  Path complete() const { return aside() / "complete"; }
  Path earlier() const { return aside() / "earlier"; }
  bool is_ours(const std::string& name) const;
  std::optional<std::string> foreign_part(const Path& entry) const;
  void check_earlier();
  void check_inputs() const;
  NewFile& new_file(const std::string& name);
  template <typename Action>
  void attempt(const std::string& problem, const Action& action) const;
  std::vector<Path> with_mark_last(const Path& folder) const;
  void repair() const;
  void undo(const std::vector<Path>& names) const;
  [[noreturn]] void refuse(const std::string& found) const;

  Path dir_;
  OutputContent content_;
  std::optional<Aside> aside_;              // until the commit
  std::map<std::string, NewFile> growing_;  // files of append()
  std::vector<Path> replaced_;  // names of the entries of DIR that commit() removes, the mark first
};

}  // namespace stereotlm::files
