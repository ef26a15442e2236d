#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "sw/files/output_file.h"
#include "sw/files/output_folder.h"

namespace stereotlm::files {

// Writes a document and its files into a folder, whose other content stays. Used by the command `paper`.
// Implemented by an OutputFolder whose mark is the document.
class DocumentFolder {
 public:
  // Throws as OutputFolder does. Also throws std::runtime_error if an entry with one of these names is no
  // file, or if one of them exists without a document of this kind, because such a file was written by
  // somebody else. `inputs`: see OutputContent.
  DocumentFolder(const std::filesystem::path& dir, const std::string& document, const FileKind& kind,
                 const std::vector<std::string>& files, const std::vector<NamedFile>& inputs = {});

  // `contents`: bytes by name. Throws std::invalid_argument if these are not exactly the document and all
  // files, and std::runtime_error if they cannot be stored.
  void commit(const std::map<std::string, std::string>& contents);

 private:
  std::vector<std::string> names_;  // the document last
  OutputFolder folder_;
};

}  // namespace stereotlm::files
