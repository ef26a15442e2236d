#include "sw/explore/sweep/worker.h"

#include <fmt/format.h>
#include <signal.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstring>
#include <new>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "sw/explore/plan/conditions.h"
#include "sw/explore/plan/figures.h"
#include "sw/explore/store/store_reader.h"

namespace stereotlm::explore {
namespace {

// A message of a worker: a point has ended, or the worker ends because of an error. The text of the error,
// `text_bytes` long, follows the message.
struct Report {
  enum class Kind : std::uint8_t { kPoint, kFailure, kConditionError };

  Kind kind = Kind::kPoint;
  PointEnd end = PointEnd::kNotBegun;
  std::uint32_t text_bytes = 0;
};

void report_end(int to, Report::Kind kind, const std::string& text) {
  const Report report = {kind, PointEnd::kNotBegun, static_cast<std::uint32_t>(text.size())};
  process::write_all(to, &report, sizeof report);
  process::write_all(to, text.data(), text.size());
}

// Renames a figure that has the same path as a key, because both have a column: bridge.posted_words is the
// number of words that the bridge can hold, bridge.posted_words.counted the number of words that it has
// taken.
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

constexpr int kOutOfMemory = 75;  // the exit status of a worker

// Runs in the process of the worker: simulates and stores points.
class PointRunner {
 public:
  PointRunner(const Points& points, const Evaluate& evaluate, const SweepOptions& options,
              const process::SharedState& shared)
      : points_(points),
        evaluate_(evaluate),
        shared_(shared),
        conditions_(points.conditions()),
        store_(options.store, options.version, options.busy_timeout) {
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
      } catch (const process::EndedBySignal&) {
        throw;
      } catch (const std::system_error&) {
        throw;
      } catch (const std::bad_alloc&) {
        throw;
      } catch (const std::exception& error) {
        end = PointEnd::kFailed;
        row = failed_point(point, error.what());
      }
    }
    const process::SharedState::Turn turn(shared_);
    return store_.add(row) ? end : PointEnd::kKnown;
  }

 private:
  const Points& points_;
  const Evaluate& evaluate_;
  const process::SharedState& shared_;
  Conditions conditions_;
  Store store_;
  std::optional<FinishedStore> known_;
};

// Runs in the process of the worker; returns its exit status.
int run_worker(const Points& points, const Evaluate& evaluate, const SweepOptions& options,
               const process::SharedState& shared, int from, int to) {
  // Ctrl-C in a terminal goes to all processes. Only the parent process, which gives the orders, handles it.
  signal(SIGINT, SIG_IGN);
  signal(SIGTERM, SIG_DFL);
  Report report;
  try {
    PointRunner runner(points, evaluate, options, shared);
    WorkOrder order;
    while (process::read_all(from, &order, sizeof order)) {
      for (std::uint64_t i = 0; i < order.count; ++i) {
        report.end = shared.stop() ? PointEnd::kNotBegun : runner.run(order.first + i * order.step);
        if (!process::write_all(to, &report, sizeof report)) return 1;
      }
    }
    return 0;
  } catch (const process::EndedBySignal& error) {
    signal(error.signal(), SIG_DFL);
    raise(error.signal());
    return 1;  // the signal does not end a process by default
  } catch (const std::bad_alloc&) {
    return kOutOfMemory;
  } catch (const ConditionError& error) {
    report_end(to, Report::Kind::kConditionError, error.what());
    return 1;
  } catch (const std::exception& error) {
    report_end(to, Report::Kind::kFailure, error.what());
    return 1;
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
               const process::SharedState& shared)
    : process_([&] {
        orders_.close_write_end();
        reports_.close_read_end();
        return run_worker(points, evaluate, options, shared, orders_.read_end(), reports_.write_end());
      }) {
  orders_.close_read_end();
  reports_.close_write_end();
}

void Worker::send(const WorkOrder& order) {
  order_ = order;
  process::write_all(orders_.write_end(), &order, sizeof order);  // receive() finds out if the worker is dead
}

std::optional<PointEnd> Worker::receive() {
  Report report;
  if (!process::read_all(descriptor(), &report, sizeof report)) {
    const int status = process_.wait();
    if (WIFSIGNALED(status)) {
      death_ = fmt::format("ended with signal {} ({})", WTERMSIG(status), strsignal(WTERMSIG(status)));
    } else if (WEXITSTATUS(status) == kOutOfMemory) {
      death_ = "run out of memory";
    } else {
      death_ = fmt::format("ended with exit status {}", WEXITSTATUS(status));
    }
    return std::nullopt;
  }
  if (report.kind != Report::Kind::kPoint) {
    std::string text(report.text_bytes, '\0');
    process::read_all(descriptor(), text.data(), text.size());
    if (report.kind == Report::Kind::kConditionError) throw ConditionError(text, text);
    throw std::runtime_error(text);
  }
  order_.first += order_.step;
  --order_.count;
  return report.end;
}

}  // namespace stereotlm::explore
