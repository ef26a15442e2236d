#pragma once

#include <nlohmann/json.hpp>
#include <string_view>

#include "platform/config/tables.h"
#include "sw/report/page_data/conflict_data.h"
#include "sw/runs/rerun.h"

namespace stereotlm::report {

// One of two compared runs, and what its repetition has recorded of waits.
struct ComparedRun {
  ComparedRun(const runs::RecordedRun& recorded, const platform::Tables& its_tables)
      : run(recorded), tables(its_tables), waits(recorded.board, recorded.folder) {}

  // Takes the files of waits among those of `run --record`.
  void record(const std::string& name, std::string_view text);

  const runs::RecordedRun& run;
  const platform::Tables& tables;
  ConflictData waits;
};

// The parts `runs` and `difference` of a page's data (sw/report/page/README.md).
nlohmann::ordered_json two_runs_data(const ComparedRun& a, const ComparedRun& b,
                                     const runs::FrameAlignment& aligned, const runs::DiffLimits& limits);

}  // namespace stereotlm::report
