#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sw/files/created_folders.h"

namespace stereotlm::files {

// The folder in DIR that holds unfinished files.
inline constexpr const char* kAsideFolder = ".partial";
// Its subfolder for the replaced files during a commit.
inline constexpr const char* kEarlierFolder = "earlier";

// The files that a command writes into a folder, DIR.
struct OutputContent {
  std::string called;  // name of DIR in messages: "result folder"
  std::string mark;    // the file that is moved into place last: if it exists, all files are complete
  // The path below DIR of something in `entry` that the command did not write ("thesis.tex", "frames/note").
  // `entry` is in DIR, or was written aside to be moved there.
  std::function<std::optional<std::string>(const std::filesystem::path& entry)> foreign;
  // Why DIR must not be written to. `was_left`: a killed run has left files there.
  std::function<std::optional<std::string>(const std::filesystem::path& dir, bool was_left)> problem;
  // Whether a commit removes an entry of DIR. Not set: it removes all entries that are not foreign.
  std::function<bool(const std::filesystem::path& entry)> replaced = nullptr;
  std::string aside = kAsideFolder;
};

// A folder whose files are replaced all together by commit(). Before, it is unchanged.
//
// New files are written to DIR/.partial (inside DIR, so that DIR may be a mount point). commit() moves them
// into place. If an earlier run was killed, the constructor first puts back the files that it had moved, and
// removes those that it left. DIR/.partial is locked: a second run is refused.
class OutputFolder {
 public:
  // Creates DIR and its missing parents and checks that DIR is writable. Changes nothing and throws
  // std::runtime_error if DIR is not writable, another run uses it, DIR/.partial holds foreign files, or
  // OutputContent reports a problem with DIR.
  OutputFolder(const std::filesystem::path& dir, OutputContent content);
  // Without commit(): removes everything that it created. An earlier result is unchanged.
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  const std::filesystem::path& path() const { return dir_; }
  // The problem that OutputContent reports for DIR now.
  std::optional<std::string> problem() const { return content_.problem(dir_, was_left_); }

  // Adds a file. `name`: "stats.json", "frames/000000.png"; each name once. Throws std::runtime_error if it
  // cannot be stored (disk full). The object can then only be destroyed.
  void add(const std::string& name, std::string_view bytes);
  // Moves all files into place. Throws std::logic_error if the mark was not added or commit() was called
  // before. If it fails, restores all files and throws std::runtime_error.
  void commit();

  // Throws std::runtime_error with the folder's name.
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
  void start_aside();
  void move_into_place() const;
  std::vector<std::filesystem::path> moved_names() const;
  void put_back() const;
  void discard() noexcept;

  std::filesystem::path dir_;
  OutputContent content_;
  CreatedFolders created_;   // DIR and parents that were missing
  int lock_ = -1;            // descriptor of DIR/.partial
  bool was_left_ = false;    // a killed run has left files in DIR/.partial
  bool owns_aside_ = false;  // this object removes DIR/.partial
  bool committed_ = false;
};

}  // namespace stereotlm::files
