#include "sw/cli/sweep_on_slurm.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <stdexcept>
#include <system_error>

#include "platform/config/board_draft.h"
#include "sw/explore/slurm/shard_folder.h"
#include "sw/explore/slurm/slurm_sweep.h"
#include "sw/files/whole_file.h"
#include "sw/process/interrupt.h"
#include "sw/process/streams.h"
#include "sw/runs/progress.h"
#include "sw/sqlite/database.h"

namespace stereotlm::cli {
namespace {

// The sweep for Slurm, with the contents of all files that its tasks need.
explore::ShardedSweep sharded(const SweepCommandOptions& options, const explore::Plan& plan,
                              const std::optional<runs::CalibrationInput>& calibration) {
  explore::ShardedSweep sweep;
  sweep.plan = files::read_whole_file(plan.path());
  if (platform::is_board_file(plan.board())) sweep.board = files::read_whole_file(plan.board());
  if (calibration) {
    const runs::InputCalibration& files = calibration->described;
    sweep.calibration = {files::read_whole_file(files.file.path), files::read_whole_file(files.left_lut.path),
                         files::read_whole_file(files.right_lut.path)};
  }
  sweep.banks = plan.banks();
  sweep.version = options.sweep.version;
  sweep.points = plan.size();
  sweep.shards = std::min(options.shards, plan.size());
  return sweep;
}

std::string line_of(const explore::SlurmProgress& progress, std::uint64_t before, double seconds) {
  std::string text = runs::progress_text(progress.counts, before, seconds);
  text += fmt::format("   {} running", progress.running);
  if (progress.waiting > 0) text += fmt::format(", {} waiting", progress.waiting);
  if (!progress.reason.empty()) text += fmt::format(" ({})", progress.reason);
  return text;
}

}  // namespace

explore::SweepCounts sweep_on_slurm(const SweepCommandOptions& options, const explore::Plan& plan,
                                    const std::optional<runs::CalibrationInput>& calibration) {
  runs::ProgressLine progress;
  const auto say_note = [&progress](const std::string& note) {
    progress.erase();
    process::say("note", note);
  };
  const auto opened = [&] {
    try {
      return explore::SlurmSweep(sharded(options, plan, calibration), options.sweep.store,
                                 options.sbatch_options, say_note);
    } catch (const sqlite::DatabaseError& error) {
      process::refuse(fmt::format("--out {}", error.what()));
    } catch (const std::system_error& error) {
      process::refuse(fmt::format("--out {}: {}", options.sweep.store, error.code().message()));
    }
  };
  explore::SlurmSweep sweep = opened();
  process::catch_interrupts();
  try {
    sweep.begin();
  } catch (const sqlite::DatabaseError& error) {
    process::refuse(fmt::format("--out {}", error.what()));
  } catch (const std::exception& error) {
    process::refuse(fmt::format("--launcher slurm: {}", error.what()));
  }
  std::optional<std::uint64_t> before;
  const auto counts = sweep.wait([&](const explore::SlurmProgress& now) {
    if (!before) before = now.counts.done();
    progress.show([&](double seconds) { return line_of(now, *before, seconds); });
    return !process::interrupted();
  });
  progress.erase();
  return counts;
}

}  // namespace stereotlm::cli
