#include "sw/explore/store/merged_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <random>
#include <system_error>
#include <vector>

#include "sw/explore/store/database.h"
#include "sw/files/replaced_file.h"

namespace stereotlm::explore {
namespace {

namespace fs = std::filesystem;

// The name of the file is the name of the store, then kMark, then kDigits hexadecimal digits. No other
// program uses such names.
constexpr const char* kMark = ".merging-";
constexpr std::size_t kDigits = 16;

void remove_leftovers(const std::string& store) {
  const std::string begin = fs::path(store).filename().string() + kMark;
  const fs::path folder = fs::path(store).parent_path();
  std::error_code ignored;
  std::vector<fs::path> leftovers;
  for (const auto& entry : fs::directory_iterator(folder.empty() ? "." : folder, ignored)) {
    const std::string name = entry.path().filename().string();
    const bool is_merged_file = name.size() == begin.size() + kDigits &&
                                name.compare(0, begin.size(), begin) == 0 &&
                                name.find_first_not_of("0123456789abcdef", begin.size()) == std::string::npos;
    if (is_merged_file) leftovers.push_back(entry.path());
  }
  for (const fs::path& path : leftovers) fs::remove(path, ignored);
}

}  // namespace

MergedFile::MergedFile(const std::string& store) {
  remove_leftovers(store);
  std::random_device random;
  int file = -1;
  do {
    path_ = fmt::format("{}{}{:08x}{:08x}", store, kMark, random(), random());
    file = open(path_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
  } while (file < 0 && errno == EEXIST);
  if (file < 0) throw DatabaseError(fmt::format("{}: cannot be made: {}", path_, std::strerror(errno)));
  close(file);
}

MergedFile::~MergedFile() {
  std::error_code ignored;
  if (!path_.empty()) fs::remove(path_, ignored);
}

void MergedFile::replace(const std::string& store) {
  try {
    files::take_place(path_, store);
  } catch (const std::system_error& error) {
    throw DatabaseError(fmt::format("{}: cannot be replaced: {}", store, error.code().message()));
  }
  path_.clear();
}

}  // namespace stereotlm::explore
