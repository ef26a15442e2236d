#include "sw/explore/sweep/sweep.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <map>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "sw/explore/store/merge_stores.h"
#include "sw/explore/store/store.h"
#include "sw/explore/store/store_lock.h"
#include "sw/explore/sweep/worker.h"

namespace stereotlm::explore {
namespace {

constexpr std::array<std::pair<const char*, std::uint64_t SweepCounts::*>, 7> kCounts = {{
    {"total", &SweepCounts::total},
    {"excluded", &SweepCounts::excluded},
    {"known", &SweepCounts::known},
    {"ok", &SweepCounts::ok},
    {"impossible", &SweepCounts::impossible},
    {"failed", &SweepCounts::failed},
    {"given_up", &SweepCounts::given_up},
}};

constexpr int kPollMs = 20;  // between two calls of keep_going

// The number of points of the shard.
std::uint64_t points_of(const Points& points, const SweepOptions& options) {
  const std::uint64_t size = points.size();
  return size > options.shard ? (size - options.shard - 1) / options.shards + 1 : 0;
}

class Sweep {
 public:
  Sweep(const Points& points, const Evaluate& evaluate, const SweepOptions& options)
      : workers_(std::min<std::uint64_t>(options.jobs, points_of(points, options))),
        state_{points, evaluate, options, {workers_.size(), points_of(points, options)}, {}} {}

  SweepCounts run(const std::function<bool(const SweepCounts&)>& keep_going) {
    if (const std::uint64_t most = workers_with_files(workers_.size()); most < workers_.size()) {
      throw std::runtime_error(
          fmt::format("{} worker processes: the limit on open files (ulimit -n) is enough for {}",
                      workers_.size(), most));
    }
    const SweepOptions& options = state_.options;
    const StoreLock lock(options.store);
    {  // One message for an unusable file, instead of one from each worker.
      const Store made(options.store, options.version, options.busy_timeout);
    }
    try {
      run_points(lock, keep_going);
      merge_stores({options.store}, options.store);
    } catch (const std::exception&) {
      lock.check();  // if the file is gone, that is the reason for the error
      throw;
    }
    return state_.claims.counts();
  }

 private:
  void run_points(const StoreLock& lock, const std::function<bool(const SweepCounts&)>& keep_going) {
    for (std::size_t place = 0; place < workers_.size(); ++place) start_worker(place);
    while (
        std::any_of(workers_.begin(), workers_.end(), [](const auto& worker) { return worker != nullptr; })) {
      if (!keep_going(state_.claims.counts())) state_.claims.stop();
      wait();
      lock.check();
    }
    keep_going(state_.claims.counts());
    lock.check();
  }

  void start_worker(std::size_t place) { workers_[place] = std::make_unique<Worker>(state_, place); }

  // Waits until a worker has ended, or it is time for keep_going.
  void wait() {
    std::vector<pollfd> watched;
    for (const auto& worker : workers_) watched.push_back({worker ? worker->descriptor() : -1, POLLIN, 0});
    const int ready = poll(watched.data(), watched.size(), kPollMs);
    if (ready < 0 && errno != EINTR) throw std::system_error(errno, std::generic_category(), "poll");
    if (ready <= 0) return;
    for (std::size_t place = 0; place < watched.size(); ++place) {
      if (watched[place].revents != 0) end_worker(place);
    }
  }

  // A worker that has died gets a successor, which begins its unfinished point again.
  void end_worker(std::size_t place) {
    const auto death = workers_[place]->wait();
    workers_[place].reset();
    if (!death) return;
    const auto claim = state_.claims.unfinished(place);
    if (claim && ++deaths_[*claim] == kMostDeaths) {
      state_.claims.end(place, fail(state_.number_of(*claim),
                                    fmt::format("its process has {}, {} times: to try again, delete this row "
                                                "and give the same command",
                                                *death, kMostDeaths)));
    }
    start_worker(place);
  }

  // Stores a point whose workers have died as a point that has failed.
  PointEnd fail(std::uint64_t number, const std::string& reason) {
    Store store(state_.options.store, state_.options.version, state_.options.busy_timeout);
    return store.add(failed_point(state_.points.point(number), reason)) ? PointEnd::kFailed
                                                                        : PointEnd::kKnown;
  }

  std::vector<std::unique_ptr<Worker>> workers_;  // [place]; nullptr: it has ended
  SweepState state_;
  std::map<std::uint64_t, int> deaths_;  // [claim]: workers that died while they simulated it
};

}  // namespace

void SweepCounts::add(const SweepCounts& other) {
  for (const auto& [name, count] : kCounts) this->*count += other.*count;
}

std::string counts_text(const SweepCounts& counts) {
  std::string text;
  for (const auto& [name, count] : kCounts) text += fmt::format("{} {}\n", name, counts.*count);
  return text;
}

SweepCounts read_counts(const std::string& text) {
  SweepCounts counts;
  std::istringstream stream(text);
  std::string read;
  for (std::uint64_t number = 0; stream >> read >> number;) {
    for (const auto& [name, count] : kCounts) {
      if (read == name) counts.*count = number;
    }
  }
  return counts;
}

SweepCounts sweep(const Points& points, const Evaluate& evaluate, const SweepOptions& options,
                  const std::function<bool(const SweepCounts& counts)>& keep_going) {
  return Sweep(points, evaluate, options).run(keep_going);
}

// Opens, for a moment, as many files as the last worker will have open. A worker inherits the end of a pipe
// for each worker before it, and opens its stores with their journals and a pipe to the process that
// simulates.
std::uint64_t workers_with_files(std::uint64_t workers) {
  constexpr std::uint64_t kOwnFiles = 16;
  std::vector<int> files;
  while (files.size() < workers + kOwnFiles) {
    const int file = open("/dev/null", O_RDONLY | O_CLOEXEC);
    if (file < 0) break;
    files.push_back(file);
  }
  for (const int file : files) close(file);
  return files.size() < kOwnFiles ? 0 : files.size() - kOwnFiles;
}

}  // namespace stereotlm::explore
