#include "sw/explore/sweep/sweep.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <map>
#include <new>
#include <optional>
#include <sstream>
#include <system_error>
#include <utility>
#include <vector>

#include "sw/process/child.h"
#include "sw/stats/figures.h"

namespace stereotlm::explore {
namespace {

constexpr int kPollMs = 20;                // between two calls of keep_going
constexpr std::chrono::seconds kGrace{1};  // for points that have begun, after keep_going has returned false

std::uint64_t points_of(const Points& points, const SweepOptions& options) {
  return points.size > options.shard ? (points.size - options.shard - 1) / options.shards + 1 : 0;
}

StoredPoint row_of(const Point& point, const std::string& status, const std::string& reason) {
  return {point.hash, status, reason, point.yaml, point.values, {}};
}

constexpr std::array<std::pair<const char*, std::uint64_t SweepCounts::*>, 7> kCounts = {{
    {"total", &SweepCounts::total},
    {"excluded", &SweepCounts::excluded},
    {"known", &SweepCounts::known},
    {"ok", &SweepCounts::ok},
    {"impossible", &SweepCounts::impossible},
    {"failed", &SweepCounts::failed},
    {"given_up", &SweepCounts::given_up},
}};

// The way in which a point has ended: an index in kCounts.
enum class PointEnd : std::uint8_t { kExcluded = 1, kKnown, kOk, kImpossible, kFailed, kGivenUp };

// A lock for the processes that share it after fork(). It is free once the process that holds it has died.
class SharedLock {
 public:
  SharedLock() : file_(memfd_create("lock", MFD_CLOEXEC)) {
    if (file_ < 0) throw std::system_error(errno, std::generic_category(), "memfd_create");
  }
  ~SharedLock() { close(file_); }
  SharedLock(const SharedLock&) = delete;
  SharedLock& operator=(const SharedLock&) = delete;

  // Calls `action` while this process holds the lock, for which it waits.
  template <typename Action>
  auto hold(const Action& action) const {
    while (lockf(file_, F_LOCK, 0) != 0) {
      if (errno != EINTR) throw std::system_error(errno, std::generic_category(), "lockf");
    }
    const struct Unlock {
      ~Unlock() { static_cast<void>(lockf(file, F_ULOCK, 0)); }
      int file;
    } unlock{file_};
    return action();
  }

 private:
  int file_;
};

// The points that the workers of a sweep have begun and ended, in memory that all its processes share. A
// point is a number from 0. Each worker has a place; when it dies, its successor takes the place over. One
// store to memory begins a point, and one ends it, so that a place is valid whenever its worker dies.
class Claims {
 public:
  Claims(std::size_t places, std::uint64_t points)
      : points_(points),
        size_(places),
        memory_(mmap(nullptr, (1 + places) * sizeof(Place), PROT_READ | PROT_WRITE,
                     MAP_SHARED | MAP_ANONYMOUS, -1, 0)) {
    if (memory_ == MAP_FAILED) throw std::system_error(errno, std::generic_category(), "mmap");
    stopped_ = new (memory_) std::atomic<bool>(false);
    places_ = static_cast<Place*>(memory_) + 1;
    std::uninitialized_value_construct_n(places_, places);
  }
  ~Claims() { munmap(memory_, (1 + size_) * sizeof(Place)); }
  Claims(const Claims&) = delete;
  Claims& operator=(const Claims&) = delete;

  // Begins a point: the one that the place has begun and not ended, else the first that no place has begun.
  // Returns nullopt if all have been begun, and after stop().
  std::optional<std::uint64_t> begin(std::size_t place) {
    if (*stopped_) return std::nullopt;
    if (const auto left = unfinished(place)) return left;
    return lock_.hold([&]() -> std::optional<std::uint64_t> {
      std::uint64_t next = 0;  // all points before it have been begun
      for (std::size_t i = 0; i < size_; ++i) next += places_[i].begun;
      if (next == points_) return std::nullopt;
      places_[place].last = next;
      ++places_[place].begun;
      return next;
    });
  }
  void end(std::size_t place, PointEnd end) { ++places_[place].ended[static_cast<std::size_t>(end)]; }
  // The point that the place has begun and not ended.
  std::optional<std::uint64_t> unfinished(std::size_t place) const {
    std::uint64_t ended = 0;
    for (const auto& number : places_[place].ended) ended += number;
    return ended == places_[place].begun ? std::nullopt : std::optional<std::uint64_t>(places_[place].last);
  }
  // Keeps every process from beginning another point.
  void stop() { *stopped_ = true; }
  // How all points have ended that have. `total` is the number of points.
  SweepCounts counts() const {
    SweepCounts counts;
    counts.total = points_;
    for (std::size_t place = 0; place < size_; ++place) {
      for (std::size_t end = 1; end < kCounts.size(); ++end)
        counts.*kCounts[end].second += places_[place].ended[end];
    }
    return counts;
  }

 private:
  // A cache line for each place, because each is written by another processor.
  struct alignas(64) Place {
    std::atomic<std::uint64_t> last;                               // the point that was begun last
    std::atomic<std::uint64_t> begun;                              // number of points
    std::array<std::atomic<std::uint64_t>, kCounts.size()> ended;  // [PointEnd]: number of points
  };

  std::uint64_t points_;
  std::size_t size_;
  void* memory_;  // a cache line for stopped_, then the places
  std::atomic<bool>* stopped_;
  Place* places_;    // [size_]
  SharedLock lock_;  // of begin()
};

struct SweepState {
  const Points& points;
  const Evaluate& evaluate;
  const SweepOptions& options;
  Claims claims;       // number i is point number shard + i * shards
  SharedLock writing;  // of the store, because SQLite's own wait polls every few milliseconds

  Point point(std::uint64_t claim) const { return points.point(options.shard + claim * options.shards); }
};

// Runs in the process of the worker: simulates and stores points.
class PointRunner {
 public:
  explicit PointRunner(const SweepState& state)
      : state_(state),
        conditions_(state.points.conditions),
        store_(state.options.store, state.options.version, state.options.busy_timeout) {
    if (!state.options.known.empty()) known_.emplace(state.options.known, state.options.version);
  }

  PointEnd run(const Point& point) {
    if (!conditions_.hold(point.values)) return PointEnd::kExcluded;
    if (store_.has(point.hash) || (known_ && known_->find(point.hash))) return PointEnd::kKnown;
    StoredPoint row = row_of(point, "impossible", point.reason);
    const PointEnd end = point.board ? simulate(point, row) : PointEnd::kImpossible;
    if (end == PointEnd::kGivenUp) return end;
    return state_.writing.hold([&] { return store_.add(row); }) ? end : PointEnd::kKnown;
  }

 private:
  PointEnd simulate(const Point& point, StoredPoint& row) const {
    row.status = "failed";
    try {
      row.figures = state_.evaluate(point);
      for (platform::BoardValue& figure : row.figures.values) figure.path = stats::figure_column(figure.path);
      row.status = "ok";
      return PointEnd::kOk;
    } catch (const GivenUp&) {
      return PointEnd::kGivenUp;
    } catch (const process::ChildDied& error) {
      if (error.signal() != 0) throw;
      row.reason = error.what();
    } catch (const std::system_error&) {
      throw;
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::exception& error) {
      row.reason = error.what();
    }
    return PointEnd::kFailed;
  }

  const SweepState& state_;
  Conditions conditions_;
  Store store_;
  std::optional<StoredRow> known_;
};

// The work of the process at a place: begins points until none is left, simulates and stores them. Sends the
// text of a ConditionError.
void run_worker(SweepState& state, std::size_t place, const process::Child::Tell& tell) {
  // Ctrl-C in a terminal goes to all processes. Only the parent process, which stops the sweep, handles it.
  std::signal(SIGINT, SIG_IGN);
  std::signal(SIGTERM, SIG_DFL);
  try {
    auto claim = state.claims.begin(place);
    if (!claim) return;
    PointRunner runner(state);
    for (; claim; claim = state.claims.begin(place)) state.claims.end(place, runner.run(state.point(*claim)));
  } catch (const process::ChildDied& error) {
    std::signal(error.signal(), SIG_DFL);
    std::raise(error.signal());
    throw;  // the signal does not end a process by default
  } catch (const ConditionError& error) {
    tell(error.what());
  }
}

// Waits for the end of a worker. Returns the way in which it died, such as "ended with signal 9 (Killed)", or
// nullopt if it has ended because no point was left to begin. Throws the error for which it had to stop.
std::optional<std::string> death_of(process::Child& worker) {
  try {
    if (const auto condition = worker.next()) throw ConditionError(*condition, *condition);
    return std::nullopt;
  } catch (const process::ChildDied& error) {
    return error.how();
  } catch (const std::bad_alloc&) {
    return "run out of memory";
  }
}

// The number of workers. Throws std::runtime_error if the limit on open files is too low for them.
std::uint64_t with_files(std::uint64_t workers) {
  const std::uint64_t most = workers_with_files(workers);
  if (most == workers) return workers;
  throw std::runtime_error(fmt::format(
      "{} worker processes: the limit on open files (ulimit -n) is enough for {}", workers, most));
}

class Sweep {
 public:
  Sweep(const Points& points, const Evaluate& evaluate, const SweepOptions& options)
      : workers_(with_files(std::min<std::uint64_t>(options.jobs, points_of(points, options)))),
        state_{points, evaluate, options, {workers_.size(), points_of(points, options)}, {}} {}

  SweepCounts run(const std::function<bool(const SweepCounts&)>& keep_going) {
    const SweepOptions& options = state_.options;
    const StoreLock lock(options.store);
    {  // One message for an unusable file, instead of one from each worker.
      const Store made(options.store, options.version, options.busy_timeout);
    }
    std::exception_ptr problem;    // SQLite calls without letting exceptions through
    std::exception_ptr condition;  // one that cannot be computed; what is done is kept all the same
    try {
      try {
        run_points(lock, keep_going);
      } catch (const ConditionError&) {
        condition = std::current_exception();
        workers_.clear();  // ends them
      }
      merge_stores({options.store}, options.store, [&] {
        try {
          keep_going(state_.claims.counts());
        } catch (...) {
          problem = std::current_exception();
        }
        return problem != nullptr;
      });
    } catch (const std::exception&) {
      if (problem) std::rethrow_exception(problem);
      lock.check();  // if the file is gone, that is the reason for the error
      throw;
    }
    if (condition) std::rethrow_exception(condition);
    return state_.claims.counts();
  }

 private:
  void run_points(const StoreLock& lock, const std::function<bool(const SweepCounts&)>& keep_going) {
    for (std::size_t place = 0; place < workers_.size(); ++place) start_worker(place);
    auto end = std::chrono::steady_clock::time_point::max();
    while (
        std::any_of(workers_.begin(), workers_.end(), [](const auto& worker) { return worker != nullptr; })) {
      const auto now = std::chrono::steady_clock::now();
      if (!keep_going(state_.claims.counts())) {
        state_.claims.stop();
        end = std::min(end, now + kGrace);
      }
      wait();
      lock.check();
      if (now > end) workers_.clear();  // ends them
    }
    keep_going(state_.claims.counts());
    lock.check();
  }

  void start_worker(std::size_t place) {
    workers_[place] = std::make_unique<process::Child>(
        [&state = state_, place](const process::Child::Tell& tell) { run_worker(state, place, tell); });
  }

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

  // A worker that has died gets a successor, which begins its unfinished point again. A point whose workers
  // have died too often is stored as failed.
  void end_worker(std::size_t place) {
    const auto death = death_of(*workers_[place]);
    workers_[place].reset();
    if (!death) return;
    const auto claim = state_.claims.unfinished(place);
    if (claim && ++deaths_[*claim] == kMostDeaths) {
      Store store(state_.options.store, state_.options.version, state_.options.busy_timeout);
      const std::string reason =
          fmt::format("its process has {}, {} times: to try again, delete this row and give the same command",
                      *death, kMostDeaths);
      const bool is_new = store.add(row_of(state_.point(*claim), "failed", reason));
      state_.claims.end(place, is_new ? PointEnd::kFailed : PointEnd::kKnown);
    }
    start_worker(place);
  }

  std::vector<std::unique_ptr<process::Child>> workers_;  // [place]; nullptr: it has ended
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

// Tries the limit: opens, for a moment, as many files as the last worker will have open. A worker inherits
// the end of a pipe for each worker before it and the file of SharedLock. It opens its stores with their
// journals, and a pipe to the process that simulates.
std::uint64_t workers_with_files(std::uint64_t workers) {
  constexpr std::uint64_t kOwnFiles = 17;
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
