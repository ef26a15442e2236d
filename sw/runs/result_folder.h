#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "sw/files/output_folder.h"

namespace stereotlm::runs {

// The name of a frame's disparities in a result folder: "frames/000000.png".
std::string frame_file_name(std::uint64_t frame);

// The folder of `run --out`, which holds one result and nothing else: an OutputFolder whose mark is run.json.
class ResultFolder {
 public:
  // Throws as OutputFolder does, and if DIR is neither empty nor a folder that holds run.json and only files
  // that `run` writes.
  explicit ResultFolder(const std::filesystem::path& dir);

  // `name`: a file that `run` writes ("stats.json", "frames/000000.png"), once each; else
  // std::invalid_argument. Throws std::runtime_error if it cannot be stored (disk full); the object is then
  // good for nothing but to be destroyed.
  void add(const std::string& name, std::string_view bytes);
  void add(const std::string& name, const std::vector<std::uint8_t>& bytes);

  // Replaces the earlier result by what was added, which must include run.json (std::logic_error). Throws
  // std::runtime_error if that fails, with the earlier result back in place.
  void commit();

 private:
  std::set<std::string> added_;
  files::OutputFolder folder_;
};

}  // namespace stereotlm::runs
