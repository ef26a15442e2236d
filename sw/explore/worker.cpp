#include "sw/explore/worker.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "sw/explore/conditions.h"
#include "sw/explore/ended_by_signal.h"
#include "sw/explore/figures.h"

namespace stereotlm::explore {
namespace {

[[noreturn]] void throw_errno(const char* what) {
  throw std::system_error(errno, std::generic_category(), what);
}

// False at the end, or if the other side is gone.
bool read_all(int from, void* bytes, std::size_t count) {
  char* next = static_cast<char*>(bytes);
  while (count > 0) {
    const ssize_t got = read(from, next, count);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    next += got;
    count -= static_cast<std::size_t>(got);
  }
  return true;
}

bool write_all(int to, const void* bytes, std::size_t count) {
  const char* next = static_cast<const char*>(bytes);
  while (count > 0) {
    const ssize_t written = write(to, next, count);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    next += written;
    count -= static_cast<std::size_t>(written);
  }
  return true;
}

// What a worker tells: the end of a point, or of itself with a text.
struct Report {
  PointEnd end = PointEnd::kNotBegun;
  bool is_failure = false;
  std::uint32_t text_bytes = 0;
};

// A figure with the path of a key is another column: bridge.posted_words is what the bridge can hold, and
// bridge.posted_words.counted what it has taken.
void take_figures(Figures figures, StoredPoint& row) {
  for (platform::BoardValue& figure : figures.values) {
    const auto is_key = [&figure](const platform::BoardValue& key) { return key.path == figure.path; };
    if (std::any_of(row.keys.begin(), row.keys.end(), is_key)) figure.path += ".counted";
  }
  row.figures = std::move(figures.values);
  row.blame = std::move(figures.blame);
}

StoredPoint row_of(const Point& point) {
  StoredPoint row;
  row.hash = point.hash;
  row.config = point.yaml;
  row.keys = point.values;
  return row;
}

// The work itself, in the process of the worker.
class PointRunner {
 public:
  PointRunner(const Points& points, const Evaluate& evaluate, const SweepOptions& options,
              const SharedState& shared)
      : points_(points),
        evaluate_(evaluate),
        shared_(shared),
        conditions_(points.conditions()),
        store_(options.store, options.version, options.patience) {
    if (!options.known.empty()) known_.emplace(options.known, options.version);
  }

  PointEnd run(std::uint64_t number) {
    const Point point = points_.point(number);
    if (!conditions_.hold(point.values)) return PointEnd::kExcluded;
    if (store_.has(point.hash) || (known_ && known_->has(point.hash))) return PointEnd::kKnown;
    StoredPoint row = row_of(point);
    PointEnd end = PointEnd::kOk;
    if (!point.board) {
      end = PointEnd::kImpossible;
      row.status = "impossible";
      row.reason = point.reason;
    } else {
      try {
        take_figures(evaluate_(point), row);
        row.status = "ok";
      } catch (const GivenUp&) {
        return PointEnd::kGivenUp;
      } catch (const EndedBySignal&) {
        throw;
      } catch (const std::system_error&) {
        throw;
      } catch (const std::exception& error) {
        end = PointEnd::kFailed;
        row = failed_point(point, error.what());
      }
    }
    const SharedState::Turn turn(shared_);
    return store_.add(row) ? end : PointEnd::kKnown;
  }

 private:
  const Points& points_;
  const Evaluate& evaluate_;
  const SharedState& shared_;
  Conditions conditions_;
  Store store_;
  std::optional<FinishedStore> known_;
};

[[noreturn]] void be_worker(const Points& points, const Evaluate& evaluate, const SweepOptions& options,
                            const SharedState& shared, pid_t parent, int from, int to) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);  // it has ended before that
  // A terminal's Ctrl-C goes to all processes; the one that hands out the work decides what it means.
  signal(SIGINT, SIG_IGN);
  signal(SIGTERM, SIG_DFL);
  Report report;
  try {
    PointRunner runner(points, evaluate, options, shared);
    WorkOrder order;
    while (read_all(from, &order, sizeof order)) {
      for (std::uint64_t i = 0; i < order.count; ++i) {
        report.end = shared.stop() ? PointEnd::kNotBegun : runner.run(order.first + i * order.step);
        if (!write_all(to, &report, sizeof report)) _exit(1);
      }
    }
    _exit(0);
  } catch (const EndedBySignal& error) {
    signal(error.signal(), SIG_DFL);
    raise(error.signal());
    _exit(1);  // a signal that does not end it
  } catch (const std::exception& error) {
    const std::string text = error.what();
    report.is_failure = true;
    report.text_bytes = static_cast<std::uint32_t>(text.size());
    write_all(to, &report, sizeof report);
    write_all(to, text.data(), text.size());
    _exit(1);
  }
}

}  // namespace

StoredPoint failed_point(const Point& point, const std::string& reason) {
  StoredPoint row = row_of(point);
  row.status = "failed";
  row.reason = reason;
  return row;
}

Worker::Worker(const Points& points, const Evaluate& evaluate, const SweepOptions& options,
               const SharedState& shared) {
  std::array<int, 2> orders{};
  std::array<int, 2> reports{};
  if (pipe2(orders.data(), O_CLOEXEC) != 0) throw_errno("pipe2");
  if (pipe2(reports.data(), O_CLOEXEC) != 0) throw_errno("pipe2");
  const pid_t parent = getpid();
  std::fflush(nullptr);  // or both processes would write what is in the buffers
  pid_ = fork();
  if (pid_ < 0) throw_errno("fork");
  if (pid_ == 0) {
    close(orders[1]);
    close(reports[0]);
    be_worker(points, evaluate, options, shared, parent, orders[0], reports[1]);
  }
  close(orders[0]);
  close(reports[1]);
  to_ = orders[1];
  from_ = reports[0];
}

Worker::~Worker() {
  close(to_);
  close(from_);
  if (pid_ < 0) return;
  kill(pid_, SIGKILL);
  while (waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

void Worker::send(const WorkOrder& order) {
  order_ = order;
  write_all(to_, &order, sizeof order);  // if it is dead, receive() says so
}

std::optional<PointEnd> Worker::receive() {
  Report report;
  if (!read_all(from_, &report, sizeof report)) {
    int status = 0;
    while (waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
    }
    pid_ = -1;
    death_ = WIFSIGNALED(status)
                 ? fmt::format("signal {} ({})", WTERMSIG(status), strsignal(WTERMSIG(status)))
                 : fmt::format("exit status {}", WEXITSTATUS(status));
    return std::nullopt;
  }
  if (report.is_failure) {
    std::string text(report.text_bytes, '\0');
    read_all(from_, text.data(), text.size());
    throw std::runtime_error(text);
  }
  order_.first += order_.step;
  --order_.count;
  return report.end;
}

}  // namespace stereotlm::explore
