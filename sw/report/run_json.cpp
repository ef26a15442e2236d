#include "sw/report/run_json.h"

#include <fmt/format.h>

#include <filesystem>
#include <stdexcept>

#include "sw/report/json_text.h"

namespace stereotlm::report {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const char* option, const InputFile& file) {
  if (!std::filesystem::path(file.path).is_absolute()) {
    throw std::runtime_error(
        fmt::format("{} '{}': not an absolute path: run.json needs one", option, file.path));
  }
  try {
    static_cast<void>(json_text(file.path));
  } catch (const std::invalid_argument&) {
    throw std::runtime_error(
        fmt::format("{} '{}': a path that is not UTF-8: run.json cannot name it", option, file.path));
  }
  return {{"path", file.path}, {"sha256", file.sha256}};
}

}  // namespace

std::string run_json(const RunOptions& options) {
  Json document = {{"schema", 1},
                   {"command", "run"},
                   {"version", options.program_version},
                   {"source", options.source},
                   {"fidelity", options.fidelity},
                   {"frames", options.frames}};
  if (options.left) document["left"] = to_json("--left", *options.left);
  if (options.right) document["right"] = to_json("--right", *options.right);
  if (options.truth) {
    document["truth"] = to_json("--truth", *options.truth);
    document["truth_scale"] = options.truth_scale;
  }
  return json_text(document);
}

}  // namespace stereotlm::report
