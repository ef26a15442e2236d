#pragma once

#include <memory>
#include <stdexcept>

#include "sw/files/temporary_folder.h"
#include "sw/process/problems.h"

namespace stereotlm::cli {

// Creates a folder for temporary files. If that fails, reports the problem and returns null. To be called
// before the command has any effect.
inline std::unique_ptr<files::TemporaryFolder> temporary_folder(process::Problems& problems) {
  try {
    return std::make_unique<files::TemporaryFolder>();
  } catch (const std::runtime_error& error) {
    problems.add(error.what());
    return nullptr;
  }
}

}  // namespace stereotlm::cli
