#include "sw/cli/board_options.h"

#include <string_view>

#include "platform/config/board_area.h"
#include "platform/config/board_yaml.h"
#include "sw/process/streams.h"

namespace stereotlm::cli {

BoardOptions::BoardOptions(Options* of, const std::string& beside_board)
    : board_(of, "BOARD", " ",
             "A preset (see stereotlm boards), or the path of a board file: has a / or ends in .yaml" +
                 beside_board,
             {required("a preset or the path of a board file")}),
      sets_(of, "--set", "KEY=VALUE",
            "Give a key of the board another value, a YAML flow value; again for further keys "
            "(see stereotlm keys)",
            {}, Takes::kRepeated),
      calibration_(of, "--calibration", "F",
                   "Tables from the calibration of a rig, as written by stereotlm calibrate, in place of the "
                   "identity") {}

std::vector<std::string> BoardOptions::words_without_allocation() const {
  constexpr std::string_view kSection = "allocation";
  std::vector<std::string> words = {name()};
  if (calibration_.is_given()) words.insert(words.end(), {"--calibration", calibration_.text()});
  for (const std::string& set : sets_.texts()) {
    if (set.substr(0, set.find_first_of(".=")) != kSection) words.insert(words.end(), {"--set", set});
  }
  return words;
}

LoadedBoard BoardOptions::load(process::Problems& problems) const {
  LoadedBoard loaded;
  problems.attempt("", [&] { loaded.board = platform::load_board(name(), sets_.texts()); });
  if (calibration_.is_given()) {
    loaded.calibration =
        runs::load_calibration(calibration_.text(), loaded.board ? &*loaded.board : nullptr, problems);
  }
  return loaded;
}

void LoadedBoard::say_clock_remark() const {
  const std::string remark = platform::clock_remark(*board);
  if (!remark.empty()) process::say("note", remark);
}

}  // namespace stereotlm::cli
