#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "sw/report/created_folders.h"

namespace stereotlm::report {

// A folder into which a document and its files go, beside whatever else it holds, which stays. It is as it
// was until commit(), and has all new files after it. They are written aside, into DIR/.partial, and moved
// into place together, the document last.
class DocumentFolder {
 public:
  // Creates DIR and its parents where missing, and proves that it can be written to. Throws
  // std::runtime_error, having changed nothing, if that fails, if one of the files is there without the
  // document (then it is somebody else's), or if something of such a name is no file.
  DocumentFolder(const std::filesystem::path& dir, const std::string& document,
                 const std::vector<std::string>& files);
  // Without commit(): removes all it made.
  ~DocumentFolder();
  DocumentFolder(const DocumentFolder&) = delete;
  DocumentFolder& operator=(const DocumentFolder&) = delete;

  // `contents`: of the document and every file, else std::invalid_argument. Throws std::runtime_error if they
  // cannot be stored.
  void commit(const std::map<std::string, std::string>& contents);

 private:
  void check_content() const;
  void discard() noexcept;
  [[noreturn]] void refuse(const std::string& found) const;

  std::filesystem::path dir_;
  std::string document_;
  std::vector<std::string> names_;  // the document last
  CreatedFolders created_;          // DIR and parents that were missing
  bool owns_aside_ = false;         // DIR/.partial is ours to remove
};

}  // namespace stereotlm::report
