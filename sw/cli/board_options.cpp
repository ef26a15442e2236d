#include "sw/cli/board_options.h"

#include <string_view>

#include "platform/config/board_area.h"
#include "platform/config/board_yaml.h"
#include "sw/process/streams.h"

namespace stereotlm::cli {

std::vector<std::string> BoardOptions::words_without_allocation() const {
  constexpr std::string_view kSection = "allocation";
  std::vector<std::string> words = {argument.text()};
  if (calibration.is_given()) words.insert(words.end(), {calibration.name(), calibration.text()});
  for (const std::string& set : sets.texts()) {
    if (set.substr(0, set.find_first_of(".=")) != kSection) words.insert(words.end(), {"--set", set});
  }
  return words;
}

LoadedBoard BoardOptions::load(process::Problems& problems) const {
  LoadedBoard loaded;
  problems.attempt("", [&] { loaded.board = platform::load_board(argument.text(), sets.texts()); });
  if (calibration.is_given()) {
    loaded.calibration =
        runs::load_calibration(calibration.text(), loaded.board ? &*loaded.board : nullptr, problems);
  }
  return loaded;
}

void LoadedBoard::say_clock_remark() const {
  const std::string remark = platform::clock_remark(*board);
  if (!remark.empty()) process::say("note", remark);
}

}  // namespace stereotlm::cli
