#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "sw/files/created_folders.h"
#include "sw/files/named_file.h"
#include "sw/files/new_file.h"

namespace stereotlm::files {

// The folder in DIR that holds unfinished files.
inline constexpr const char* kAsideFolder = ".partial";
// The subfolder of kAsideFolder that holds the replaced files during a commit.
inline constexpr const char* kEarlierFolder = "earlier";

// Describes the files that a command writes into a folder, DIR.
struct OutputContent {
  std::string called;  // name of DIR in messages: "result folder"
  // The file that is moved into place last: if it exists, all files are complete. Empty: no such file.
  std::string mark;
  // Returns the path below DIR of a file in `entry` that the command did not write ("thesis.tex",
  // "frames/note"); nullopt if there is none. `entry` is in DIR, or in the folder of unfinished files.
  std::function<std::optional<std::string>(const std::filesystem::path& entry)> foreign;
  // Returns the reason why DIR must not be written to; nullopt if there is none. `was_left`: a killed run has
  // left unfinished files in DIR.
  std::function<std::optional<std::string>(const std::filesystem::path& dir, bool was_left)> problem;
  // Whether a commit removes an entry of DIR. Not set: it removes all entries that are not foreign.
  std::function<bool(const std::filesystem::path& entry)> replaced = nullptr;
  std::string aside = kAsideFolder;  // name of the folder of unfinished files
  // The files that the command reads. None may lie where a commit removes it.
  std::vector<NamedFile> inputs = {};
};

// The output folder of a command. commit() replaces its files all together; until then they are unchanged.
// Only files that were there when the object was made are replaced.
//
// New files are written to DIR/.partial (inside DIR, so that DIR may be a mount point). commit() moves them
// into place. If an earlier run was killed, the constructor undoes its unfinished commit and removes its new
// files. While the object exists, DIR/.partial is locked, so that a second run is refused.
class OutputFolder {
 public:
  // Creates DIR and its missing parents and checks that DIR is writable. Throws std::runtime_error, and
  // changes nothing, if DIR is not writable, another run uses it, DIR/.partial holds foreign files, an input
  // would be replaced, or OutputContent reports a problem with DIR.
  OutputFolder(const std::filesystem::path& dir, OutputContent content);
  // Without commit(): removes everything that this object has created. An earlier result is unchanged.
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  const std::filesystem::path& path() const { return dir_; }
  // The problem that OutputContent reports for DIR now.
  std::optional<std::string> problem() const { return content_.problem(dir_, was_left_); }

  // Adds a file. `name`: "stats.json", "frames/000000.png"; each name once. Throws std::runtime_error if it
  // cannot be stored (disk full). The object can then only be destroyed.
  void add(const std::string& name, std::string_view bytes);
  // Adds bytes to the end of a file that is written piece by piece. Throws as add() does.
  void append(const std::string& name, std::string_view bytes);
  // Moves all files into place. Throws std::logic_error if the mark was not added or commit() was called
  // before. If it fails, restores all files and throws std::runtime_error.
  void commit();

  // Throws std::runtime_error: the name of the folder and `found`.
  [[noreturn]] void refuse(const std::string& found) const;

 private:
  bool is_replaced(const std::filesystem::path& entry) const {
    return content_.replaced ? content_.replaced(entry) : !content_.foreign(entry);
  }
  std::filesystem::path aside() const { return dir_ / content_.aside; }
  std::filesystem::path made() const;
  std::filesystem::path earlier() const;
  void lock();
  bool try_lock();
  void check_aside();
  void check_inputs() const;
  void start_aside();
  void move_into_place() const;
  std::vector<std::filesystem::path> moved_names() const;
  bool is_unfinished() const;
  void put_back() const;
  void discard() noexcept;
  [[noreturn]] void refuse_file(const std::string& name, const std::error_code& cause) const;

  std::filesystem::path dir_;
  OutputContent content_;
  std::map<std::string, NewFile> growing_;       // files of append()
  CreatedFolders created_;                       // DIR and parents that were missing
  std::vector<std::filesystem::path> replaced_;  // names of the entries of DIR that commit() removes
  int lock_ = -1;                                // descriptor of DIR/.partial
  bool was_left_ = false;                        // a killed run has left files in DIR/.partial
  bool owns_aside_ = false;                      // this object removes DIR/.partial
  bool committed_ = false;
};

}  // namespace stereotlm::files
