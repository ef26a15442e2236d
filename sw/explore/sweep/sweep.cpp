#include "sw/explore/sweep/sweep.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <deque>
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
#include "sw/process/shared_state.h"

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

constexpr std::uint64_t kMostOfAnOrder = 16;  // points
constexpr int kPollMs = 100;                  // between two calls of keep_going

// Ignores SIGPIPE while it exists. Writing to a worker that has died must not end this process; receive()
// detects the death.
class IgnoredSigpipe {
 public:
  IgnoredSigpipe() : before_(signal(SIGPIPE, SIG_IGN)) {}
  ~IgnoredSigpipe() { signal(SIGPIPE, before_); }
  IgnoredSigpipe(const IgnoredSigpipe&) = delete;
  IgnoredSigpipe& operator=(const IgnoredSigpipe&) = delete;

 private:
  void (*before_)(int);
};

class Sweep {
 public:
  Sweep(const Points& points, const Evaluate& evaluate, const SweepOptions& options)
      : points_(points), evaluate_(evaluate), options_(options) {
    const std::uint64_t size = points.size();
    counts_.total = size > options.shard ? (size - options.shard - 1) / options.shards + 1 : 0;
  }

  SweepCounts run(const std::function<bool(const SweepCounts&)>& keep_going) {
    const std::uint64_t workers = std::min<std::uint64_t>(options_.jobs, counts_.total);
    if (const std::uint64_t most = workers_with_files(workers); most < workers) {
      throw std::runtime_error(fmt::format(
          "{} worker processes: the limit on open files (ulimit -n) is enough for {}", workers, most));
    }
    workers_.resize(workers);
    const StoreLock lock(options_.store);
    {  // One message for an unusable file, instead of one from each worker.
      const Store made(options_.store, options_.version, options_.busy_timeout);
    }
    try {
      run_points(lock, keep_going);
      merge_stores({options_.store}, options_.store);
    } catch (const std::exception&) {
      lock.check();  // if the file is gone, that is the reason for the error
      throw;
    }
    return counts_;
  }

 private:
  void run_points(const StoreLock& lock, const std::function<bool(const SweepCounts&)>& keep_going) {
    for (std::size_t place = 0; place < workers_.size(); ++place) start_worker(place);
    while (is_busy()) {
      if (!keep_going(counts_)) shared_.stop() = true;
      wait();
      lock.check();
    }
    workers_.clear();
    keep_going(counts_);
    lock.check();
  }

  bool is_busy() const {
    return std::any_of(workers_.begin(), workers_.end(),
                       [](const auto& worker) { return worker->order().count > 0; });
  }

  void start_worker(std::size_t place) {
    workers_[place] = std::make_unique<Worker>(points_, evaluate_, options_, shared_);
    give_order(*workers_[place]);
  }

  // Gives a worker the next points, if there are any. Points that a dead worker has left come first.
  void give_order(Worker& worker) {
    if (shared_.stop()) return;
    if (!left_.empty()) {
      worker.send(left_.front());
      left_.pop_front();
      return;
    }
    const std::uint64_t rest = counts_.total - next_;
    // The orders get smaller towards the end, so that all workers finish at about the same time.
    const std::uint64_t count =
        std::min(rest, std::clamp<std::uint64_t>(rest / (4 * workers_.size()), 1, kMostOfAnOrder));
    if (count == 0) return;
    worker.send({options_.shard + next_ * options_.shards, options_.shards, count});
    next_ += count;
  }

  void wait() {
    std::vector<pollfd> watched;
    for (const auto& worker : workers_) watched.push_back({worker->descriptor(), POLLIN, 0});
    const int ready = poll(watched.data(), watched.size(), kPollMs);
    if (ready < 0 && errno != EINTR) throw std::system_error(errno, std::generic_category(), "poll");
    if (ready <= 0) return;
    for (std::size_t i = 0; i < watched.size(); ++i) {
      if (watched[i].revents != 0) receive(i);
    }
  }

  void receive(std::size_t place) {
    Worker& worker = *workers_[place];
    if (worker.order().count == 0) return;
    const auto end = worker.receive();
    if (end) {
      count(*end);
      if (worker.order().count == 0) give_order(worker);
      return;
    }
    WorkOrder order = worker.order();
    if (++deaths_[order.first] == kMostDeaths) {
      fail(order.first,
           fmt::format("its process has {}, {} times: to try again, delete this row and give the "
                       "same command",
                       worker.death(), kMostDeaths));
      order.first += order.step;
      --order.count;
    }
    if (order.count > 0) left_.push_back(order);
    start_worker(place);
  }

  // Stores a point whose worker has died as a point that has failed.
  void fail(std::uint64_t number, const std::string& reason) {
    Store store(options_.store, options_.version, options_.busy_timeout);
    count(store.add(failed_point(points_.point(number), reason)) ? PointEnd::kFailed : PointEnd::kKnown);
  }

  void count(PointEnd end) {
    switch (end) {
      case PointEnd::kExcluded:
        ++counts_.excluded;
        break;
      case PointEnd::kKnown:
        ++counts_.known;
        break;
      case PointEnd::kOk:
        ++counts_.ok;
        break;
      case PointEnd::kImpossible:
        ++counts_.impossible;
        break;
      case PointEnd::kFailed:
        ++counts_.failed;
        break;
      case PointEnd::kGivenUp:
        ++counts_.given_up;
        break;
      case PointEnd::kNotBegun:
        break;
    }
  }

  const Points& points_;
  const Evaluate& evaluate_;
  const SweepOptions& options_;
  IgnoredSigpipe ignored_sigpipe_;
  process::SharedState shared_;
  SweepCounts counts_;
  std::uint64_t next_ = 0;  // first point of this shard that no worker was given, as an index in the shard
  std::deque<WorkOrder> left_;           // orders that dead workers have not finished
  std::map<std::uint64_t, int> deaths_;  // [number of a point]: workers that died while they simulated it
  std::vector<std::unique_ptr<Worker>> workers_;  // destroyed before shared_
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

// Opens, for a moment, as many files as the last worker will have open. A worker inherits two ends of pipes
// for each worker before it, and opens its stores with their journals and a pipe to the process that
// simulates.
std::uint64_t workers_with_files(std::uint64_t workers) {
  constexpr std::uint64_t kOwnFiles = 16;
  std::vector<int> files;
  while (files.size() < 2 * workers + kOwnFiles) {
    const int file = open("/dev/null", O_RDONLY | O_CLOEXEC);
    if (file < 0) break;
    files.push_back(file);
  }
  for (const int file : files) close(file);
  return files.size() < kOwnFiles ? 0 : (files.size() - kOwnFiles) / 2;
}

}  // namespace stereotlm::explore
