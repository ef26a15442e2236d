#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "sw/files/output_folder.h"

namespace stereotlm::files {

// A folder into which a document and its files go, beside whatever else it holds, which stays: an
// OutputFolder whose mark is the document.
class DocumentFolder {
 public:
  // Throws as OutputFolder does, and if one of the files is there without the document (then it is somebody
  // else's), or if something of such a name is no file.
  DocumentFolder(const std::filesystem::path& dir, const std::string& document,
                 const std::vector<std::string>& files);

  // `contents`: of the document and every file, else std::invalid_argument. Throws std::runtime_error if they
  // cannot be stored.
  void commit(const std::map<std::string, std::string>& contents);

 private:
  std::vector<std::string> names_;  // the document last
  OutputFolder folder_;
};

}  // namespace stereotlm::files
