#pragma once

#include <optional>
#include <string>
#include <vector>

#include "platform/config/board_config.h"
#include "sw/cli/command.h"
#include "sw/explore/optimise/search_store.h"
#include "sw/explore/plan/plan.h"
#include "sw/process/client.h"

namespace stereotlm::cli {

// "90s", "5min", "2h": seconds; nullopt for any other text.
std::optional<double> seconds_of(const std::string& text);

struct OptimiseOptions : Options {
  using Options::Options;

  process::FileContents sent = process::sent_files({"plan.yaml"});
  Option plan = Option(this, "PLAN", " ", "A plan as sweep takes it, a preset, or a board file",
                       {required("a plan or a board")});
  Option sets = Option(this, "--set", "KEY=VALUE",
                       "Give a key of the board another value, a YAML flow value; again for further keys", {},
                       Takes::kRepeated);
  Option requirements = Option(this, "--for", "CONDITION",
                               "What a board must keep, such as 'frames_per_second.core >= 60'; again for "
                               "further conditions",
                               {}, Takes::kRepeated);
  Option maxima = Option(this, "--maximise", "FIGURE",
                         "A figure, a key or an SQL expression over them, that is to be large; again for "
                         "further goals",
                         {}, Takes::kRepeated);
  Option minima = Option(this, "--minimise", "FIGURE", "The same, that is to be small", {}, Takes::kRepeated);
  Option banks = Option(this, "--banks", "N", "Place the buffers in at most N banks, in every different way",
                        {number<int>("1..64", [](int n) { return n >= 1 && n <= 64; })});
  Option stripes = Option(this, "--stripes", "M", "Each buffer in one bank, or striped over up to M",
                          {number<int>("1..16", [](int n) { return n >= 1 && n <= 16; })});
  Option source = Option(this, "--source", "camera|preloaded",
                         "The whole computer, the default where a goal or condition needs it, or the "
                         "core alone; a plan says it in run.source",
                         {one_of({"camera", "preloaded"})});
  Option calibration = Option(this, "--calibration", "F", "The tables, in place of the identity");
  Option why = Option(this, "--why", "KEY=VALUE",
                      "Say why the board of the plan with this value is not the best; again for further keys",
                      {}, Takes::kRepeated);
  Option within = Option(this, "--within", "TIME", "End after 90s, 5min or 2h with the best so far",
                         {valid("a time such as 90s, 5min or 2h",
                                [](const std::string& text) { return seconds_of(text).has_value(); })});
  Option out = Option(this, "--out", "DB",
                      "The database of the answer and its certificate, written or continued (default: none)");
  Option jobs = Option(this, "--jobs", "N", "Worker processes; default: the processors of this machine",
                       {number<unsigned>("1..1024", [](unsigned n) { return n >= 1 && n <= 1024; })});
  JsonOption json{this};

  void check_together(process::Problems& problems) override {
    if (why.is_given() && json.is_given()) problems.add("--why: does not go with --json");
  }
};

// What the command is to find: a plan, and the goals and conditions of plan and options.
struct Question {
  std::optional<explore::Plan> plan;
  explore::SearchWishes wishes;
  std::string text;               // of the plan; of a board the plan that is made from it
  std::string varied;             // of a board: what the plan varies, as text
  std::string board_name;         // a preset or a board file
  std::vector<std::string> sets;  // of that board
  platform::BoardConfig board;    // the board with them
  std::string calibration;        // its path; empty: none
};

// The plan of the options, or the plan that varies the usual knobs of their board.
Question question_of(const OptimiseOptions& options);

// As a store keeps it. `tables`: SHA-256 of those of a calibration; empty: the identity.
explore::SearchStore::Asked asked_of(const Question& question, const std::string& tables);

}  // namespace stereotlm::cli
