#include <fmt/format.h>

#include <string>
#include <vector>

#include "sw/cli/command.h"
#include "sw/explore/store/store.h"
#include "sw/explore/store/store_lock.h"
#include "sw/process/interrupt.h"
#include "sw/process/streams.h"

namespace stereotlm::cli {
namespace {

struct MergeOptions : Options {
  using Options::Options;

  Option out = Option(this, "OUT", " ", "The database to write", {required("the database to write")});
  Option inputs = Option(this, "DB", "...", "Databases of sweep, such as those of its shards",
                         {required("the databases to merge")}, Takes::kList);
};

int merge(const MergeOptions& options) {
  try {
    const explore::StoreLock lock(options.out.text());
    process::catch_interrupts();
    explore::merge_stores(options.inputs.texts(), options.out.text(), process::interrupted);
  } catch (const sqlite::DatabaseError& error) {
    if (process::interrupted()) return interrupted("nothing is written");
    process::refuse(error.what());
  }
  sqlite::Database merged(options.out.text(), sqlite::Database::Access::kRead);
  const std::size_t inputs = options.inputs.texts().size();
  process::print(fmt::format("{}: {} points of {} database{}\n", options.out.text(),
                             merged.number("SELECT count(*) FROM points"), inputs, inputs == 1 ? "" : "s"));
  return kDone;
}

}  // namespace

void add_merge(CLI::App& program, Action& action) {
  add_command(
      program, action, "merge", "Put the points of several databases of sweep into one", merge,
      "The bytes of OUT depend on nothing but the points: neither on the number of databases nor on their\n"
      "order. OUT may be one of them. Databases that hold different results of one point are an error.");
}

}  // namespace stereotlm::cli
