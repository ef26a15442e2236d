#include "sw/report/chart/chart_traffic.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <numeric>
#include <stdexcept>

#include "sw/report/chart/chart_text.h"
#include "sw/report/wait_text.h"

namespace stereotlm::report {
namespace {

using Json = nlohmann::json;

// `words` in the time of `clocks` clocks of `mhz`.
double rate(std::uint64_t words, std::uint64_t clocks, double mhz) {
  return clocks == 0 ? 0 : 4.0 * static_cast<double>(words) * mhz / static_cast<double>(clocks);
}

double percent(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0 : 100 * static_cast<double>(part) / static_cast<double>(whole);
}

const Json& entry(const Json& list, const std::string& name) {
  for (const Json& each : list) {
    if (each.at("name") == name) return each;
  }
  throw std::runtime_error(fmt::format("has no entry of '{}'", name));
}

std::uint64_t number(const Json& object, const char* key) { return object.at(key).get<std::uint64_t>(); }

class TrafficReader {
 public:
  TrafficReader(const platform::BoardConfig& board, const Json& stats) : board_(board), stats_(stats) {}

  ChartTraffic read() {
    if (stats_.contains("pci")) traffic_.extent = ChartExtent::kComputer;
    if (stats_.at("banks").size() != board_.banks.size())
      throw std::runtime_error(
          fmt::format("has {} banks, the board {}", stats_.at("banks").size(), board_.banks.size()));
    read_core_ports();
    read_banks();
    if (traffic_.extent == ChartExtent::kComputer) read_parts_around();
    read_limits();
    read_summary();
    return std::move(traffic_);
  }

 private:
  void set(const std::string& from, const std::string& to, double megabytes_per_second) {
    traffic_.megabytes_per_second[ChartLink{from, to}.id()] = megabytes_per_second;
  }

  double core_rate(std::uint64_t words) const { return rate(words, cycles_, board_.fpga.clock_mhz); }

  // The number of frames that use entry `index` of a list of `length` buffers.
  std::uint64_t uses(std::size_t index, std::size_t length) const {
    return frames_ / length + (index < frames_ % length ? 1 : 0);
  }

  void read_core_ports() {
    for (const fpga::CorePort& port : fpga::kPorts) {
      const Json& figures = entry(stats_.at("ports"), port.name);
      const std::uint64_t grants = number(figures, "grants");
      traffic_.waits_percent[std::string("port-") + port.name] =
          percent(number(figures, "stall_cycles"), cycles_);
      const std::vector<std::string> banks = banks_of(board_, port);
      if (banks.empty()) continue;
      if (frames_ > 0 && grants % frames_ != 0)
        throw std::runtime_error(fmt::format("{} grants of port {} in {} frames: not equally many in each",
                                             grants, port.name, frames_));
      std::map<std::string, std::uint64_t> accesses;
      for (std::size_t i = 0; i < banks.size(); ++i)
        accesses[banks[i]] += frames_ == 0 ? 0 : grants / frames_ * uses(i, banks.size());
      for (const auto& [bank, words] : accesses) {
        accesses_of_core_[bank] += words;
        set(std::string("port-") + port.name, "bank-" + bank, core_rate(words));
      }
    }
  }

  void read_banks() {
    const std::uint64_t host_grants =
        number(entry(stats_.at("ports"), fpga::kPorts[fpga::kHostPort].name), "grants");
    std::set<std::string> host_banks;
    for (const ChartLink& link : chart_links(board_, traffic_.extent)) {
      if (link.from == "port-host") host_banks.insert(link.to);
    }
    std::uint64_t of_host = 0;
    for (const platform::BankConfig& bank : board_.banks) {
      const Json& figures = entry(stats_.at("banks"), bank.name);
      const std::uint64_t all = number(figures, "reads") + number(figures, "writes");
      const std::uint64_t of_core = accesses_of_core_[bank.name];
      if (all < of_core)
        throw std::runtime_error(
            fmt::format("{} accesses of bank {}: its ports made {}", all, bank.name, of_core));
      of_host += all - of_core;
      traffic_.busy_percent["bank-" + bank.name] = 100 * figures.at("utilization").get<double>();
      if (host_banks.count("bank-" + bank.name) > 0)
        set("port-host", "bank-" + bank.name, core_rate(all - of_core));
    }
    if (of_host != host_grants)
      throw std::runtime_error(
          fmt::format("{} grants of port host: the banks have {}", host_grants, of_host));
  }

  void read_parts_around() {
    const Json& pci = stats_.at("pci");
    const auto words = [&pci](const char* master) {
      return number(entry(pci.at("masters"), master), "words");
    };
    const auto on_pci = [&](std::uint64_t moved) {
      return rate(moved, number(pci, "clocks"), board_.pci.clock_mhz);
    };
    for (const char* side : {"left", "right"}) {
      const std::string board = fmt::format("{}_capture", side);
      const double captured = on_pci(words(board.c_str()));
      set(fmt::format("part-{}_camera", side), "part-" + board, captured);
      set("part-" + board, "part-pci", captured);
    }
    const bool to_host = board_.capture.destination == platform::CaptureDestination::kHostMemory;
    const std::uint64_t captured = to_host ? words("left_capture") + words("right_capture") : 0;
    set("part-cpu", "part-pci", on_pci(words("host")));
    set("part-pci", "part-host_memory", on_pci(words("bridge") + captured));
    if (board_.pci.load) set("part-load", "part-pci", on_pci(words("load")));
    traffic_.busy_percent["part-pci"] = percent(number(pci, "busy_clocks"), number(pci, "clocks"));

    const Json& bridge = stats_.at("bridge");
    const std::uint64_t posted = number(bridge, "posted_words");
    set("part-pci", "part-bridge", on_pci(posted));
    set("part-bridge", "part-pci", on_pci(words("bridge")));
    const std::uint64_t clocks = number(bridge, "local_clocks");
    const double local = rate(posted + number(bridge, "dma_words"), clocks, board_.bridge.local_clock_mhz);
    set("part-bridge", "part-local_bus", local);
    set("part-local_bus", "port-host", local);
    traffic_.busy_percent["part-local_bus"] = percent(number(bridge, "local_busy_clocks"), clocks);
  }

  void add_limit(const std::string& resource) {
    const auto begins = [&resource](const std::string& word) {
      return resource.compare(0, word.size(), word) == 0;
    };
    if (resource == "camera") {
      traffic_.limiting.insert({"part-left_camera", "part-right_camera"});
    } else if (begins("bank ") || begins("port ")) {
      traffic_.limiting.insert(resource.substr(0, 4) + "-" + resource.substr(5));
    } else {
      traffic_.limiting.insert((resource == "matcher" ? "stage-" : "part-") + resource);
    }
  }

  // What limits the whole computer, if there is one.
  void read_limits() {
    const Json& bound = stats_.at("bound");
    const bool is_whole = bound.contains("system_limited_by");
    const std::string resource =
        bound.at(is_whole ? "system_limited_by" : "core_limited_by").get<std::string>();
    if (!resource.empty()) add_limit(resource);
  }

  void read_summary() {
    const bool is_whole = traffic_.extent == ChartExtent::kComputer;
    const Json& rates = stats_.at("frames_per_second");
    const auto rate = [&rates](const char* key) { return rate_text(rates.at(key).get<double>()); };
    std::string text =
        rate(is_whole ? "system" : "core") + " frames/s" + (is_whole ? ", from power-up" : ", core only");
    if (is_whole && rates.contains("steady"))
      text = rate("steady") + " frames/s, steady; " + rate("system") + " from power-up";
    traffic_.summary = {fmt::format("{}; {} frame{}", text, frames_, frames_ == 1 ? "" : "s")};
    const Json& bound = stats_.at("bound");
    const double limit = bound.at(is_whole ? "system" : "core").get<double>();
    const std::string by = bound.at(is_whole ? "system_limited_by" : "core_limited_by").get<std::string>();
    traffic_.summary.push_back(
        fmt::format("bound {} frames/s, set by {}", rate_text(limit), resource_words(by)));
  }

  const platform::BoardConfig& board_;
  const Json& stats_;
  ChartTraffic traffic_;
  std::uint64_t frames_ = number(stats_, "frames");
  std::uint64_t cycles_ = number(stats_, "cycles");
  std::map<std::string, std::uint64_t> accesses_of_core_;  // by the bank's name
};

}  // namespace

ChartTraffic chart_traffic(const platform::BoardConfig& board, const std::string& stats_json) {
  try {
    const Json stats = Json::parse(stats_json);
    return TrafficReader(board, stats).read();
  } catch (const nlohmann::json::exception& error) {
    throw std::runtime_error(fmt::format("must be as run writes it: {}", error.what()));
  }
}

}  // namespace stereotlm::report
