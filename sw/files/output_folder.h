#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sw/files/output_file.h"
#include "sw/files/whole_file.h"

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
  bool others_stay = false;        // DIR may hold other files too, which stay
  std::string kept = {};           // an entry of DIR that stays, although the command may write it
  std::string aside = ".partial";  // name of the folder of unfinished files, in DIR
  // The files that the command reads. None may lie where a commit removes it.
  std::vector<NamedFile> inputs = {};
};

// The output folder of a command. commit() replaces its files all together; until then they are unchanged.
// Only files that were there when the object was made are replaced.
//
// New files are written to DIR/.partial (inside DIR, so that DIR may be a mount point). commit() moves them
// into place. If a run is killed before its commit, a Remover removes what the object has created. If it was
// killed in its commit, the next constructor completes that commit, or undoes it if
// not all earlier files had been moved away. While the object exists, DIR/.partial is locked, so that a
// second run is refused.
class OutputFolder {
 public:
  // Creates DIR and its missing parents. Completes or undoes the commit of a killed run. Throws
  // std::runtime_error, without other changes, if DIR is not writable or in use, lies in a result folder of
  // `run` or is one of another command, if an input would be replaced, or if files are there that the command
  // does not write (see OutputContent::others_stay) or that OutputContent::kind does not accept.
  OutputFolder(const std::filesystem::path& dir, OutputContent content);
  // Without commit(): removes everything that this object has created. Earlier files are unchanged.
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;
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
  bool is_ours(const std::string& name) const;
  std::filesystem::path aside() const { return dir_ / content_.aside; }
  std::filesystem::path made() const { return aside() / "new"; }
  std::filesystem::path complete() const { return aside() / "complete"; }
  std::filesystem::path earlier() const { return aside() / "earlier"; }
  void create_folders();
  bool try_lock();
  std::optional<std::string> foreign_part(const std::filesystem::path& entry) const;
  void check_aside() const;
  void check_earlier();
  void check_inputs() const;
  void start_aside();
  NewFile& new_file(const std::string& name);
  template <typename Action>
  void store(const std::string& name, const Action& action) const;
  std::vector<std::filesystem::path> with_mark_last(const std::filesystem::path& folder) const;
  void move_into_place(const std::vector<std::filesystem::path>& names) const;
  void repair() const;
  void undo_commit(const std::vector<std::filesystem::path>& names) const;
  void discard() noexcept;
  [[noreturn]] void refuse(const std::string& found) const;

  std::filesystem::path dir_;
  OutputContent content_;
  std::map<std::string, NewFile> growing_;       // files of append()
  std::vector<std::filesystem::path> created_;   // DIR and parents that were missing, outermost first
  std::vector<std::filesystem::path> replaced_;  // names of the entries of DIR that commit() removes
  int lock_ = -1;                                // descriptor of DIR/.partial
  bool owns_aside_ = false;                      // this object removes DIR/.partial
  bool committed_ = false;
  std::optional<Remover> remover_;
};

}  // namespace stereotlm::files
