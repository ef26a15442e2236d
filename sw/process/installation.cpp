#include "sw/process/installation.h"

namespace stereotlm::process {

std::filesystem::path installed_path(const std::string& from_program) {
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe");
  return (program.parent_path() / from_program).lexically_normal();
}

}  // namespace stereotlm::process
