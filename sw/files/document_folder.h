#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "sw/files/output_folder.h"

namespace stereotlm::files {

// A folder that gets a document and its files. All else in it stays. An OutputFolder whose mark is the
// document.
class DocumentFolder {
 public:
  // Throws as OutputFolder does, if something of such a name is no file, and if one of the files exists without
  // the document: then it belongs to somebody else.
  DocumentFolder(const std::filesystem::path& dir, const std::string& document,
                 const std::vector<std::string>& files);

  // `contents` has the document and every file, else throws std::invalid_argument. Throws std::runtime_error
  // if they cannot be stored.
  void commit(const std::map<std::string, std::string>& contents);

 private:
  std::vector<std::string> names_;  // the document last
  OutputFolder folder_;
};

}  // namespace stereotlm::files
