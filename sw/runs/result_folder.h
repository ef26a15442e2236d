#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "sw/files/output_folder.h"

namespace stereotlm::runs {

// The file name of a frame's disparities in a result folder: "frames/000000.png".
std::string frame_file_name(std::uint64_t frame);

// Writes the folder of `run --out`, which holds one result and nothing else. Implemented by an OutputFolder
// whose mark (the file that is moved into place last) is run.json.
class ResultFolder {
 public:
  // Throws as OutputFolder does, and if DIR is neither empty nor a folder that holds run.json and only files
  // that `run` writes. `inputs`: see OutputContent.
  explicit ResultFolder(const std::filesystem::path& dir, std::vector<files::NamedFile> inputs = {});

  // Adds a file that `run` writes ("stats.json", "frames/000000.png"), each name once. Throws
  // std::invalid_argument for another name, and std::runtime_error if the file cannot be stored (disk full).
  // The object can then only be destroyed.
  void add(const std::string& name, std::string_view bytes);
  void add(const std::string& name, const std::vector<std::uint8_t>& bytes);

  // Adds bytes to the end of a file that only append() writes. Throws as add() does.
  void append(const std::string& name, std::string_view bytes);

  // Replaces the earlier result by the added files. Throws std::logic_error if run.json is not among them. If
  // the replacement fails, restores the earlier result and throws std::runtime_error.
  void commit();

 private:
  void check_new(const std::string& name);

  std::set<std::string> added_;
  std::set<std::string> appended_;  // those of added_ that append() writes
  files::OutputFolder folder_;
};

}  // namespace stereotlm::runs
