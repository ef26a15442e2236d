#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "sw/cli/optimise_question.h"
#include "sw/explore/optimise/search.h"

namespace stereotlm::cli {

// How a search has ended.
struct Answer {
  explore::Search& search;
  const Question& question;
  bool is_proven = true;
  std::uint64_t boards = 0;
  bool is_counted = true;
  explore::Search::Impossible impossible = {};
  double seconds = 0;
};

// For --json.
nlohmann::ordered_json document_of(const Answer& answer);

// What is printed: how many boards there are, the front, and whether it is proven. Searches once more, with
// `model`, for the requirement that leaves nothing.
std::string text_of(const Answer& answer, const explore::BoardModel& model, unsigned processes);

// Why a board is not on the front, behind "this board ".
std::string judgement_text(const explore::Search::Judgement& judgement, const explore::Search& search,
                           bool is_proven);

}  // namespace stereotlm::cli
