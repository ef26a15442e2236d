#include "sw/explore/plan/knobs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <utility>
#include <variant>

#include "models/fpga/core_ports.h"
#include "models/kernels/filter_kernel.h"
#include "platform/config/board_keys.h"
#include "platform/config/board_reader.h"
#include "platform/config/board_yaml.h"
#include "platform/config/buffer_layout.h"
#include "platform/figures/bounds.h"
#include "sw/explore/store/store.h"

namespace stereotlm::explore {
namespace {

using platform::bank_text;
using platform::BankConfig;
using platform::BoardConfig;
using platform::Buffer;
using platform::cost_text;
using platform::Key;
using platform::PlacedBuffer;

constexpr int kTurnaroundCycles = 2;    // typical, contract section 2
constexpr int kCensusSize = 5;          // of a board that gets the census cost
constexpr std::size_t kQuietBanks = 4;  // that a new buffer is tried in

bool begins_with(const std::string& text, const char* beginning) { return text.rfind(beginning, 0) == 0; }

std::string counted(std::size_t buffers) {
  return fmt::format("{} buffer{}", buffers, buffers == 1 ? "" : "s");
}

bool is_of_computer(const std::string& path) {
  return begins_with(path, "cameras.") || begins_with(path, "capture.") || begins_with(path, "pci.") ||
         begins_with(path, "bridge.");
}

class Steps {
 public:
  Steps(const BoardConfig& board, bool camera, const std::optional<std::string>& joint_problem)
      : board_(board), camera_(camera), joint_problem_(joint_problem) {}

  void add_keys() {
    if (camera_ && board_.pci.load)
      add({"pci.load", "as it is", "none"}, [](BoardConfig& b) { b.pci.load.reset(); });
    for (const Key& key : platform::board_keys()) {
      const bool stays = begins_with(key.path, "image.") || key.path == "fpga.device" ||
                         key.path == "fpga.package" || key.path == "fpga.tables" ||  // add_tables()
                         (begins_with(key.path, "pci.load") && !board_.pci.load);
      if (stays || (is_of_computer(key.path) && !camera_)) continue;
      add_key(key);
    }
  }

  void add_filters() {
    const auto& now = board_.matcher.filter;
    const std::string from = !now ? "none" : now == kernels::log7() ? "log7" : "its own";
    const auto add_filter = [&](const std::optional<kernels::FilterKernel>& filter, const char* to) {
      if (from != to)
        add({"matcher.filter", from, to, {}, true}, [&](BoardConfig& b) { b.matcher.filter = filter; });
    };
    add_filter(std::nullopt, "none");
    add_filter(kernels::log7(), "log7");
  }

  // Only the number of folds changes the time.
  void add_units() {
    const auto& now = board_.matcher.units;
    const int disparities = board_.matcher.disparities;
    const auto fewest = [disparities](int folds) { return (disparities + folds - 1) / folds; };
    const auto add_to = [&](const std::optional<int>& other) {
      const auto text = [](const std::optional<int>& value) {
        return value ? std::to_string(*value) : "all";
      };
      add({"matcher.units", text(now), text(other)}, [&](BoardConfig& b) { b.matcher.units = other; });
    };
    const int folds = fpga::folds_of(disparities, now.value_or(disparities));
    if (folds > 2) add_to(fewest(folds - 1));
    if (fewest(folds) > 1) add_to(fewest(fpga::folds_of(disparities, fewest(folds) - 1)));
    if (now) add_to(std::nullopt);
  }

  void add_tables() {
    const auto& left = board_.allocation.left_lut;
    const auto& right = board_.allocation.right_lut;
    if (!left || !right) return;
    if (!board_.fpga.joint_tables) {
      for (const platform::BufferBanks& banks : {*left, *right}) {
        std::string in;
        for (const std::string& bank : banks.banks) in += (in.empty() ? "joint in " : ", ") + bank_text(bank);
        add_best({"fpga.tables", "separate", in}, [&](BoardConfig& b) {
          b.fpga.joint_tables = true;
          b.allocation.left_lut = b.allocation.right_lut = banks;
        });
        if (*left == *right) break;
      }
      return;
    }
    BoardConfig separate = board_;
    separate.fpga.joint_tables = false;
    if (right->is_striped()) return;
    const PlacedBuffer right_lut = platform::buffers(separate).back();
    const auto free = std::find_if(board_.banks.begin(), board_.banks.end(), [&](const BankConfig& bank) {
      return buffers_in(bank.name) == 0 && can_hold(bank, right_lut);
    });
    if (free != board_.banks.end()) separate.allocation.right_lut = free->name;
    const std::string to =
        "separate, right_lut in " + bank_text(separate.allocation.right_lut->banks.front());
    add_best({"fpga.tables", "joint", to}, [&](BoardConfig& b) { b = separate; });
  }

  void add_costs() {
    using kernels::CostKind;
    const kernels::MatchingCost& now = board_.matcher.cost;
    std::vector<kernels::MatchingCost> others = {
        {CostKind::kSad, 0}, {CostKind::kSsd, 0}, {CostKind::kZncc, 0}};
    if (now.kind == CostKind::kCensus) {
      others.push_back({CostKind::kCensus, now.census_size + 2});
      others.push_back({CostKind::kCensus, now.census_size - 2});
    } else {
      others.push_back({CostKind::kCensus, kCensusSize});
    }
    for (const kernels::MatchingCost& cost : others) {
      if (cost == now) continue;
      add({"matcher.cost", cost_text(now), cost_text(cost), {}, true},
          [&](BoardConfig& b) { b.matcher.cost = cost; });
    }
  }

  void add_priorities() {
    using Order = memory::PriorityList;
    const Order& list = board_.fpga.arbiter.priority;
    const auto names = [](const Order& order) {
      std::vector<std::string> ports;
      for (const memory::Port port : order) ports.emplace_back(fpga::kPortGroups[port].name);
      return fmt::format("{}", fmt::join(ports, ", "));
    };
    std::set<Order> known = {list};
    const auto add_order = [&](const Order& order, const std::string& from, const std::string& to) {
      if (!known.insert(order).second) return;
      add({"fpga.priority", from, to}, [&](BoardConfig& b) { b.fpga.arbiter.priority = order; });
    };
    for (std::size_t first = 0; first + 1 < list.size(); ++first) {
      Order order = list;
      std::swap(order[first], order[first + 1]);
      const auto pair = [&](const Order& of) { return names(Order{of[first], of[first + 1]}); };
      add_order(order, pair(list), pair(order));
    }
    for (std::size_t place = 0; place < list.size(); ++place) {
      const std::string name = fpga::kPortGroups[list[place]].name;
      const auto at = [place](Order& order) { return order.begin() + static_cast<std::ptrdiff_t>(place); };
      Order order = list;
      std::rotate(order.begin(), at(order), at(order) + 1);
      add_order(order, "this order", name + " first");
      order = list;
      std::rotate(at(order), at(order) + 1, order.end());
      add_order(order, "this order", name + " last");
    }
  }

  void add_kinds() {
    std::set<memory::BankKind> kinds;
    for (const BankConfig& bank : board_.banks) kinds.insert(bank.kind);
    const std::string from = kinds.size() > 1 ? "different" : memory::traits_of(*kinds.begin()).name;
    for (const memory::BankTraits& traits : memory::kBankTraits) {
      if (from == traits.name || traits.kind == memory::BankKind::kSdram) continue;
      add({"ssram.banks.*.kind", from, traits.name}, [&](BoardConfig& b) {
        for (BankConfig& bank : b.banks) {
          bank.kind = traits.kind;
          bank.sdram.reset();
          if (!traits.has_turnaround) {
            bank.turnaround_cycles = 0;
          } else if (bank.turnaround_cycles == 0) {
            bank.turnaround_cycles = kTurnaroundCycles;
          }
        }
      });
    }
  }

  // Changes the turnaround of all banks in one step, except those without turnaround.
  void add_turnarounds() {
    std::set<int> cycles;
    for (const BankConfig& bank : board_.banks) {
      if (memory::traits_of(bank.kind).has_turnaround) cycles.insert(bank.turnaround_cycles);
    }
    if (cycles.empty()) return;
    const bool is_one = cycles.size() == 1;
    for (const int change : {1, -1}) {
      add({"ssram.banks.*.turnaround_cycles", is_one ? std::to_string(*cycles.begin()) : "different",
           is_one ? std::to_string(*cycles.begin() + change)
                  : std::string("one ") + (change > 0 ? "more" : "less") + " each"},
          [&](BoardConfig& b) {
            for (BankConfig& bank : b.banks) {
              if (memory::traits_of(bank.kind).has_turnaround) bank.turnaround_cycles += change;
            }
          });
    }
  }

  void add_buffers() {
    const auto lengthen = [this](const std::string& knob, std::size_t size, const std::string& banks,
                                 const auto& change) {
      add({knob,
           counted(size),
           fmt::format("{}, in {}", counted(size + 1), banks),
           {},
           false,
           knob + " more"},
          change);
    };
    const std::string pairs = fmt::format("{}, {}", key_of(Buffer::kLeftImage), name_of(Buffer::kRightImage));
    const std::size_t size = board_.allocation.left_image.size();
    for (const std::string& left : quiet_banks(Buffer::kLeftImage)) {
      for (const std::string& right : quiet_banks(Buffer::kRightImage)) {
        lengthen(pairs, size, bank_text(left) + " and " + bank_text(right), [&](BoardConfig& b) {
          b.allocation.left_image.push_back(left);
          b.allocation.right_image.push_back(right);
        });
      }
    }
    add({pairs, counted(size), counted(size - 1)}, [](BoardConfig& b) {
      b.allocation.left_image.pop_back();
      b.allocation.right_image.pop_back();
    });
    const std::string results = key_of(Buffer::kDisparity);
    const std::size_t count = board_.allocation.disparity.size();
    for (const std::string& bank : quiet_banks(Buffer::kDisparity))
      lengthen(results, count, bank_text(bank),
               [&](BoardConfig& b) { b.allocation.disparity.push_back(bank); });
    add({results, counted(count), counted(count - 1)},
        [](BoardConfig& b) { b.allocation.disparity.pop_back(); });
  }

  void add_banks_more() {
    std::string name = "new_bank";
    const auto is_name = [&](const BankConfig& bank) {
      return bank.name == name || differ_in_case(bank.name, name);
    };
    while (std::any_of(board_.banks.begin(), board_.banks.end(), is_name)) name += '_';
    for (const PlacedBuffer& buffer : platform::buffers(board_)) {
      if (buffers_in(buffer.bank) < 2) continue;
      const std::string from = fmt::format("{} in {}", buffer.label(), bank_text(buffer.bank));
      const auto move_to = [&](const std::string& bank, const std::string& to, const auto& prepare) {
        add_best({"a bank more", from, to}, [&](BoardConfig& b) {
          prepare(b);
          move_buffer(b, buffer, bank);
        });
      };
      bool is_held = false;
      for (const BankConfig& bank : board_.banks) {
        if (buffers_in(bank.name) > 0 || !can_hold(bank, buffer)) continue;
        is_held = true;
        move_to(bank.name, "in " + bank_text(bank.name), [](BoardConfig& /*board*/) {});
      }
      if (is_held) continue;
      move_to(name, "in a new bank", [&](BoardConfig& b) {
        b.banks.push_back(bank_of(buffer.bank));
        b.banks.back().name = name;
      });
    }
  }

  void add_banks_less() {
    for (const BankConfig& left : board_.banks) {
      for (const BankConfig& taking : board_.banks) {
        if (left.name == taking.name || buffers_in(left.name) == 0 || buffers_in(taking.name) == 0) continue;
        const std::string into = "into " + bank_text(taking.name);
        add_best({"a bank less", bank_text(left.name), into}, [&](BoardConfig& b) {
          for (const PlacedBuffer& buffer : platform::buffers(board_)) {
            if (buffer.bank == left.name) move_buffer(b, buffer, taking.name);
          }
        });
      }
    }
  }

  KnobSteps take() {
    KnobSteps all = {std::move(steps_), {}};
    std::set<std::string> groups;  // with a possible or a listed step
    for (const KnobStep& step : all.possible) groups.insert(step.group);
    for (KnobStep& step : forbidden_) {
      if (step.group.empty() || groups.insert(step.group).second) all.forbidden.push_back(std::move(step));
    }
    return all;
  }

 private:
  // Adds the step to the board that `change` makes of this one.
  template <typename Change>
  void add(KnobStep step, const Change& change) {
    step.board = board_;
    change(step.board);
    const std::vector<std::string> problems = platform::problems(step.board);
    if (problems.empty() && step.board.fpga.joint_tables && joint_problem_)
      return forbid(std::move(step), *joint_problem_);
    if (problems.empty()) {
      step.sets = platform::sets_between(board_, step.board);
      steps_.push_back(std::move(step));
      return;
    }
    std::set<std::string> rules;
    for (const platform::BrokenRule& rule :
         platform::broken_rules(step.board, [](const auto&) { return true; }))
      rules.insert(rule.text);
    const auto is_rule = [&](const std::string& problem) { return rules.count(problem) > 0; };
    if (!std::all_of(problems.begin(), problems.end(), is_rule)) return;  // out of the range of its key
    forbid(std::move(step), problems.front());
  }
  void forbid(KnobStep step, const std::string& reason) {
    step.reason = reason;
    forbidden_.push_back(std::move(step));
  }
  // One of several alternatives.
  template <typename Change>
  void add_best(KnobStep step, const Change& change) {
    step.group = step.knob;
    add(std::move(step), change);
  }

  // The steps of a number or a word. Any other value has no step, or one of its own.
  void add_key(const Key& key) {
    if (!key.access.get) return;
    const platform::KeyValue now = key.access.get(board_);
    if (key.rule.decimals) return add_decimals(key, std::get<double>(now));
    if (!key.rule.integers) return add_words(key, std::get<std::string>(now));
    if (key.rule.words.empty()) add_integers(key, std::get<std::int64_t>(now));
  }
  void add_integers(const Key& key, std::int64_t from) {
    std::vector<std::int64_t> changes = {key.rule.integers->step, -key.rule.integers->step};
    // Whether pixels are lost because the FIFOs are short is seen with FIFOs that are much longer.
    if (key.path == "capture.fifo_words")
      changes.push_back(std::max(std::int64_t{platform::CaptureConfig{}.fifo_words}, 2 * from) - from);
    for (const std::int64_t change : changes) {
      add({key.path,
           std::to_string(from),
           std::to_string(from + change),
           {},
           begins_with(key.path, "matcher.") && key.path != "matcher.rows"},
          [&](BoardConfig& b) { key.access.set(b, from + change); });
    }
  }
  void add_decimals(const Key& key, double from) {
    std::set<double, std::greater<>> others = {from + 1, from - 1};
    // Words of the local bus wait least if one of its clock and the FPGA's is a multiple of the other.
    const double fpga = board_.fpga.clock_mhz;
    const double local = board_.bridge.local_clock_mhz;
    if (key.path == "bridge.local_clock_mhz")
      others.insert({fpga, 2 * fpga, platform::clock_in_step(board_)});
    if (key.path == "fpga.clock_mhz" && camera_ && std::abs(local / fpga - 1) < 0.1) others.insert(local);
    others.erase(from);
    for (const double other : others) {
      add({key.path, fmt::format("{:g}", from), fmt::format("{:g}", other)},
          [&](BoardConfig& b) { key.access.set(b, other); });
    }
  }
  void add_words(const Key& key, const std::string& now) {
    for (const std::string& other : key.rule.words) {
      if (other == now) continue;
      const bool is_line_buffer = key.path == "matcher.fetch" && board_.matcher.fetch == fpga::Fetch::kColumn;
      std::string to = other;
      if (is_line_buffer && board_.matcher.rows != 1) to += ", matcher.rows 1";
      if (is_line_buffer && board_.fpga.lanes != 1) to += ", fpga.lanes 1";
      add({key.path, now, to}, [&](BoardConfig& b) {
        key.access.set(b, other);
        if (is_line_buffer) b.matcher.rows = b.fpga.lanes = 1;  // as the line buffer needs
      });
    }
  }

  std::size_t buffers_in(const std::string& bank) const {
    std::size_t count = 0;
    for (const PlacedBuffer& buffer : platform::buffers(board_)) count += buffer.bank == bank ? 1 : 0;
    return count;
  }
  bool can_hold(const BankConfig& bank, const PlacedBuffer& buffer) const {
    std::uint64_t words = buffer_words(buffer, board_.image);
    for (const PlacedBuffer& held : platform::buffers(board_)) {
      if (held.bank == bank.name) words += buffer_words(held, board_.image);
    }
    return static_cast<std::uint64_t>(bank.words) >= words;
  }

  // The names of at most kQuietBanks banks that can hold one more buffer of this list. Banks without a buffer
  // of the list come before the others; within both groups, fewer accesses come first. A picture or table has
  // one access for each slot, a result two for each four pixels.
  std::vector<std::string> quiet_banks(Buffer list) const {
    const int rows = board_.matcher.rows;
    const bool is_column = board_.matcher.fetch == fpga::Fetch::kColumn;
    const double slots =
        is_column ? static_cast<double>(board_.matcher.window + rows - 1) / rows : 1;  // a pixel
    const std::vector<PlacedBuffer> all = platform::buffers(board_);
    std::map<std::string, std::pair<bool, double>> order;
    for (const PlacedBuffer& buffer : all) {
      const auto in_list = std::count_if(
          all.begin(), all.end(), [&](const PlacedBuffer& other) { return other.buffer == buffer.buffer; });
      auto& [has_list, accesses] = order[buffer.bank];
      has_list = has_list || buffer.buffer == list;
      accesses += (buffer.buffer == Buffer::kDisparity ? 0.5 : slots) / static_cast<double>(in_list);
    }
    std::vector<std::string> banks;
    for (const BankConfig& bank : board_.banks) {
      if (can_hold(bank, {list, 0, bank.name})) banks.push_back(bank.name);
    }
    std::stable_sort(banks.begin(), banks.end(),
                     [&](const std::string& a, const std::string& b) { return order[a] < order[b]; });
    banks.resize(std::min(banks.size(), kQuietBanks));
    return banks;
  }

  const BankConfig& bank_of(const std::string& name) const {
    return *std::find_if(board_.banks.begin(), board_.banks.end(),
                         [&](const BankConfig& bank) { return bank.name == name; });
  }

  const BoardConfig& board_;
  bool camera_;  // the computer is explained too
  const std::optional<std::string>& joint_problem_;
  std::vector<KnobStep> steps_;
  std::vector<KnobStep> forbidden_;
};

}  // namespace

KnobSteps knob_steps(const BoardConfig& board, bool camera, const std::optional<std::string>& joint_problem) {
  Steps steps(board, camera, joint_problem);
  steps.add_keys();
  steps.add_units();
  steps.add_tables();
  steps.add_costs();
  steps.add_filters();
  steps.add_priorities();
  steps.add_kinds();
  steps.add_turnarounds();
  steps.add_buffers();
  steps.add_banks_more();
  steps.add_banks_less();
  return steps.take();
}

}  // namespace stereotlm::explore
