#include <algorithm>
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>

#include "platform/config/board_area.h"
#include "platform/config/board_draft.h"
#include "sw/cli/command.h"
#include "sw/cli/optimise_answer.h"
#include "sw/cli/optimise_question.h"
#include "sw/cli/run_options.h"
#include "sw/cli/searching.h"
#include "sw/files/text_forms.h"
#include "sw/runs/simulation/board_model.h"
#include "sw/runs/sources/calibration_input.h"

namespace stereotlm::cli {
namespace {

using explore::Search;
using Clock = std::chrono::steady_clock;

int optimise(const OptimiseOptions& options) {
  Question question = question_of(options);
  const auto calibration = calibration_of(*question.plan, options.calibration, options.sent);
  const explore::Plan& plan = *question.plan;
  process::Problems problems;
  runs::PointQuality quality(*question.plan, problems);
  problems.check();
  const explore::BoardModel model =
      runs::board_model(calibration ? &calibration->tables : nullptr, std::move(quality));
  const unsigned processes =
      options.jobs.number<unsigned>().value_or(std::max(1U, std::thread::hardware_concurrency()));
  check_jobs(processes,
             question.wishes.most_banks > 0 ? processes : std::min<std::uint64_t>(processes, plan.size()));
  std::unique_ptr<Search> search;
  process::attempt_or_refuse(
      "", [&] { search = std::make_unique<Search>(plan, question.wishes, model, processes); });
  std::optional<platform::BoardDraft> asked;
  process::attempt_or_refuse("--why ", [&] {
    if (options.why.is_given()) asked = plan.base();
    std::vector<platform::Diagnostic> problems_of_values;
    for (const std::string& set : options.why.texts()) asked->set(set);
    if (!asked) return;
    for (const platform::Diagnostic& problem : asked->read_with_problems().problems) {
      if (!problem.is_between_keys) problems_of_values.push_back({"--why", problem.text});
    }
    if (!problems_of_values.empty()) throw platform::BoardError(problems_of_values);
  });
  std::optional<explore::SearchStore> store;
  process::attempt_or_refuse("--out ", [&] {
    if (!options.out.is_given()) return;
    store.emplace(options.out.text(),
                  asked_of(question, calibration ? runs::sha256_of(calibration->tables) : ""));
  });
  process::catch_interrupts();
  const auto start = Clock::now();
  Answer answer = {*search, question};
  if (store && store->is_finished()) {
    search->set_front(store->front(question.wishes.goals.size()));
    answer.boards = store->boards();
    answer.impossible = store->impossible();
  } else {
    answer.is_proven = run_search(*search, store ? &*store : nullptr, question.wishes.goals.size() == 1,
                                  seconds_of(options.within.text()));
    answer.boards = search->state().boards;
    answer.is_counted = search->state().is_counted;
    answer.impossible = search->impossible();
    if (store && answer.is_proven) store->finish(*search);
  }
  answer.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  std::string text =
      options.json.is_given() ? json_text(document_of(answer)) : text_of(answer, model, processes);
  const auto& sets = options.why.texts();
  const bool places = std::none_of(sets.begin(), sets.end(),
                                   [](const std::string& set) { return set.rfind("allocation", 0) == 0; });
  if (asked)
    text +=
        "this board " + judgement_text(search->judge(*asked, plan.run(), places), *search, answer.is_proven);
  for (const explore::FrontPoint& point : search->front()) {
    const std::string remark = platform::clock_remark(*search->board(point.first.front()).board);
    if (remark.empty()) continue;
    process::say("note", remark);
    break;
  }
  process::print(text);
  if (!process::interrupted()) return kDone;
  return interrupted(resume_text(store.has_value()));
}

}  // namespace

void add_optimise(Commands& commands) {
  add_command(
      commands, "optimise", "Find the best boards of a plan, or for a task, and prove it", optimise,
      "A plan of sweep, and in it\n"
      "  placements: {banks: N, stripes: M}   # every different way to place the buffers in at most N "
      "banks,\n"
      "                                       # each in one, or striped over up to M\n"
      "  maximise: [FIGURE, ..]               # figures (stereotlm keys --figures), keys, SQL expressions\n"
      "  minimise: [FIGURE, ..]\n"
      "  require: [CONDITION, ..]             # such as frames_per_second.core >= 25\n"
      "With one goal all boards that tie for the best are found, with several the front: no other board is\n"
      "at least as good in all goals and better in one. Of a BOARD the usual knobs are varied: modules, "
      "rows,\n"
      "lanes, fetch, cache, queues, tables and all placements.\n"
      "A condition on a rate with an uncertainty holds if it holds for all rates that this leaves open.\n"
      "Ctrl-C, or --within, ends the search with the best so far. DB is continued by the same command.");
}

}  // namespace stereotlm::cli
