#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "sw/report/created_folders.h"

namespace stereotlm::report {

// The name of a frame's disparities in a result folder: "frames/000000.png".
std::string frame_file_name(std::uint64_t frame);

// The folder of `--out`. It holds an earlier result or nothing until commit(), and the new result whole after
// it.
//
// New files are written aside, into DIR/.partial (inside DIR, so that DIR may be a mount point), and moved
// into place together. A `.partial` that a killed run left behind is cleaned away. DIR is locked meanwhile: a
// second run into it is refused.
class ResultFolder {
 public:
  // Creates DIR and its parents where missing, and proves that it can be written to. Throws
  // std::runtime_error, having changed nothing, if DIR is neither empty nor a folder that holds run.json and
  // only files that `run` writes, is in use by another run, or cannot be written to.
  explicit ResultFolder(const std::filesystem::path& dir);

  // Without commit(): removes all it made; an earlier result stays as it was.
  ~ResultFolder();
  ResultFolder(const ResultFolder&) = delete;
  ResultFolder& operator=(const ResultFolder&) = delete;

  // `name`: a file that `run` writes ("stats.json", "frames/000000.png"), once each; else
  // std::invalid_argument. Throws std::runtime_error if it cannot be stored (disk full); the object is then
  // good for nothing but to be destroyed.
  void add(const std::string& name, std::string_view bytes);
  void add(const std::string& name, const std::vector<std::uint8_t>& bytes);

  // Replaces the earlier result by what was added, which must include run.json (std::logic_error). Throws
  // std::runtime_error if that fails, with the earlier result back in place.
  void commit();

 private:
  void lock();
  void check_content() const;
  void start_aside();
  void discard() noexcept;
  [[noreturn]] void refuse(const std::string& found) const;

  std::filesystem::path dir_;
  CreatedFolders created_;  // DIR and parents that were missing
  std::set<std::string> added_;
  int lock_ = -1;            // descriptor of DIR
  bool owns_aside_ = false;  // DIR/.partial is ours to remove
  bool committed_ = false;
};

}  // namespace stereotlm::report
