#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sw/files/aside.h"

// What is promised about the files that a command writes, each with a test in tests/unit/sw/files:
//  - Before the commit all earlier files are as they were, after it all new files are in place and durable.
//  - A commit that fails, or is killed, leaves all earlier files or all new ones; after a kill, once the next
//    command has begun to write there.
//  - Only files that this program has written are replaced. Nothing that appears meanwhile is replaced, and
//    no file that the same command reads or writes otherwise.
//  - A result folder of `run` holds nothing else.
//  - One process at a time writes a file or folder. Whatever ends it, nothing unfinished is left.
//  - A single file keeps its mode and owner, and a link to it stays.
//  - An error names the file of the user and the cause.
namespace stereotlm::files {

// The file by which a result folder of `run` is known.
inline constexpr const char* kResultMark = "run.json";

// Why nothing may be written to the path: a result folder of `run` is above it, which holds nothing else.
// nullopt if none is. The path need not exist.
std::optional<std::string> result_folder_problem(const std::filesystem::path& path);

// A file that an option or an argument of a command names, directly or by its folder.
struct NamedFile {
  std::string option;
  std::string path;

  std::string text() const { return option + " '" + path + "'"; }
};

// Follows symbolic links to a file, which need not exist, and returns its path. Throws std::system_error.
std::filesystem::path linked_file(const std::filesystem::path& path);

// Throws std::runtime_error if the file, which need not exist, is one of `others`, also by symbolic or hard
// links. An empty path is no file.
void check_is_another(const std::filesystem::path& file, const std::vector<NamedFile>& others);

// A kind of file that a command writes.
struct FileKind {
  std::string called;  // in messages: "page of stereotlm report"
  // Whether this program has written the file, which exists and is not empty. Must not be true by chance.
  std::function<bool(const std::filesystem::path& file)> is_own;
  // Endings of files that would change what a reader sees in a new file: "-wal" of a database.
  std::vector<std::string> journals = {};
};

// A kind whose files have these bytes at these places. No other program writes them there.
FileKind marked_kind(std::string called, std::vector<std::pair<std::size_t, std::string>> marks);

// Renames a file or a folder. Throws std::filesystem::filesystem_error if `to` exists.
void rename_to_new(const std::filesystem::path& from, const std::filesystem::path& to);

// A single file that a command writes. Its new bytes go to a hidden folder beside it, ".NAME.writing". All
// functions throw std::runtime_error with the path and the cause.
class OutputFile {
 public:
  // Throws also if a file is there that is neither empty nor of the kind, or is one of `others` (those that
  // the command reads or writes too), or would lie in a result folder of `run`, or if the folder is not
  // writable. Changes nothing.
  OutputFile(const std::filesystem::path& path, FileKind kind, const std::vector<NamedFile>& others = {});

  void write(std::string_view bytes);
  // The unfinished file, for a library or a program that writes the content in place of write(). Files beside
  // it, with the same name and a further ending, vanish with it.
  std::filesystem::path unfinished();
  // Makes the new content durable. Several files that belong together are all completed before the first of
  // them is committed. No write() may follow.
  void complete();
  // Puts the new content in place. Throws also if another file has appeared there.
  void commit();

 private:
  void begin();
  bool check() const;  // whether there is a file
  template <typename Action>
  void named(const Action& action) const;
  [[noreturn]] void refuse(const std::string& cause) const;

  std::string name_;
  std::filesystem::path path_;  // without links
  FileKind kind_;
  bool was_there_ = false;
  std::optional<Aside> aside_;  // from the first write on
  std::optional<NewFile> new_;  // until complete()
};

}  // namespace stereotlm::files
