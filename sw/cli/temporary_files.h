#pragma once

#include <memory>
#include <stdexcept>

#include "sw/files/temporary_folder.h"
#include "sw/process/problems.h"

namespace stereotlm::cli {

// A folder for temporary files, made before a command has done anything. Null, and reported, if there can be
// none.
inline std::unique_ptr<files::TemporaryFolder> temporary_folder(process::Problems& problems) {
  try {
    return std::make_unique<files::TemporaryFolder>();
  } catch (const std::runtime_error& error) {
    problems.add(error.what());
    return nullptr;
  }
}

}  // namespace stereotlm::cli
