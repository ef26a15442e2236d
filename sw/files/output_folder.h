#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sw/files/created_folders.h"

namespace stereotlm::files {

// Where DIR keeps what is under way.
inline constexpr const char* kAsideFolder = ".partial";
// In it, while a commit goes on: what it replaces.
inline constexpr const char* kEarlierFolder = "earlier";

// Which files a command writes into a folder, DIR.
struct OutputContent {
  std::string called;  // what DIR is in messages: "result folder"
  std::string mark;    // the file that is put into place last: with it the others are whole
  // What of an entry is not the command's own, as seen from DIR ("thesis.tex", "frames/note"). `entry`: of
  // DIR, or one that a run has written aside to be one of DIR.
  std::function<std::optional<std::string>(const std::filesystem::path& entry)> foreign;
  // Why DIR must not be written to. `was_left`: a run that was killed has left files there.
  std::function<std::optional<std::string>(const std::filesystem::path& dir, bool was_left)> problem;
  // Whether an entry of DIR goes when the new files come; none: what is not foreign.
  std::function<bool(const std::filesystem::path& entry)> replaced = nullptr;
  std::string aside = kAsideFolder;
};

// A folder that is as it was until commit(), and has all new files after it, in place of the earlier ones.
//
// New files are written aside, into DIR/.partial (inside DIR, so that DIR may be a mount point), and moved
// into place together. What a run has left there that was killed meanwhile is cleaned away, and what it had
// moved is put back first. DIR/.partial is locked: a second run is refused.
class OutputFolder {
 public:
  // Creates DIR and its parents where missing, and proves that it can be written to. Throws
  // std::runtime_error, having changed nothing, if it cannot be, if it is in use by another run, if
  // something in DIR/.partial is not ours, or if the content has a problem with DIR.
  OutputFolder(const std::filesystem::path& dir, OutputContent content);
  // Without commit(): removes all it made; an earlier result stays as it was.
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  const std::filesystem::path& path() const { return dir_; }
  // That the content has with DIR now.
  std::optional<std::string> problem() const { return content_.problem(dir_, was_left_); }

  // `name`: "stats.json", "frames/000000.png", once each. Throws std::runtime_error if it cannot be stored
  // (disk full); the object is then good for nothing but to be destroyed.
  void add(const std::string& name, std::string_view bytes);
  // Once, with the mark, else std::logic_error. Throws std::runtime_error if it fails, with all back in
  // place.
  void commit();

  // Throws std::runtime_error that names the folder.
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
  bool was_left_ = false;    // a run that was killed has left something in DIR/.partial
  bool owns_aside_ = false;  // DIR/.partial is ours to remove
  bool committed_ = false;
};

}  // namespace stereotlm::files
