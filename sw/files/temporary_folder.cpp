#include "sw/files/temporary_folder.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>
#include <system_error>

namespace stereotlm::files {

TemporaryPlace temporary_place() {
  for (const char* variable : {"TMPDIR", "TMP", "TEMP", "TEMPDIR"}) {
    const char* const folder = std::getenv(variable);
    if (folder != nullptr && *folder != '\0') return {variable, folder};
  }
  return {"TMPDIR", "/tmp"};
}

TemporaryFolder::TemporaryFolder() {
  const TemporaryPlace place = temporary_place();
  const auto refuse = [&place](const std::string& rule) {
    throw std::runtime_error(fmt::format("{} = {}: {}", place.variable, place.folder, rule));
  };
  std::error_code error;
  if (!std::filesystem::is_directory(place.folder, error)) refuse("must be a folder");
  std::string name = (std::filesystem::path(place.folder) / "stereotlm_XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr)
    refuse(fmt::format("must be a folder that takes temporary files: {}", std::strerror(errno)));
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace stereotlm::files
