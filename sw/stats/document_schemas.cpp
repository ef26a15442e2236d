#include "sw/stats/document_schemas.h"

#include <map>

#include "sw/stats/json_schema.h"
#include "sw/stats/stats_json.h"

namespace stereotlm::stats {
namespace {

Schema number_list() { return list_of(count(), 1); }
Schema names() { return list_of(text(), 1); }
Schema source() { return one_of_words({"camera", "preloaded"}); }

Schema with_pattern(const char* pattern) { return {{"type", "string"}, {"pattern", pattern}}; }

// A part of `diff` that is there, or the reason for which it is not.
Schema or_not_compared(const Schema& part) {
  return either(part, object_of({{"not_compared", text(), "the reason"}}));
}

Schema allocate_schema() {
  Schema rates = either(either(object_of({{"core", any_number()}}), object_of({{"exact", any_number()}})),
                        object_of({{"steady", any_number()}, {"steady_uncertainty", amount()}}));
  rates["description"] =
      "A rate as stats.json names it: of the core alone; of the whole computer the exact rate of the long "
      "run, where it is proven, else the steady one.";
  Schema sets = list_of(with_pattern("^allocation\\.[a-z_]+="), 3);
  sets["description"] = "Values of --set that give the board this allocation.";
  const Schema best = object_of({
      {"banks", from_one()},
      {"frames_per_second", rates},
      {"tied", from_one(), "Allocations that tie for the best of all, with any number of banks."},
      {"highest_frames_per_second", rates, "Of these, the highest rate."},
      {"possible_frames_per_second", any_number(),
       "No allocation to at most most_banks banks gives more. Equal to the highest rate if that has no "
       "uncertainty and is proved to be the best."},
      {"possible_gain_percent", amount(), "So much more than the highest rate."},
      {"sets", sets},
      {"command", list_of({{"type", "string"}}, 3),
       "The words of the command that runs this allocation, and gives its rate."},
  });
  Schema banks = object_of({
      {"banks", from_one()},
      {"allocations", from_one(), "Allocations to so many banks that fit."},
      {"tied", count(), "Allocations that tie for the best with so many banks. 0: none counts."},
      {"frames_per_second?", rates},
      {"bound_frames_per_second?", any_number(), "Upper bound of the rate of the allocation in sets."},
      {"sets?", sets},
  });
  require_together(banks, {"frames_per_second", "bound_frames_per_second", "sets"});
  Schema schema = document_of(
      "What `stereotlm allocate --json` prints",
      {
          {"state", one_of_words({"complete", "interrupted"}),
           "State of the search. interrupted: the figures are those so far."},
          {"board", text(), "Name of the board."},
          {"source", source(), "The whole computer, or the core alone."},
          {"frames", from_one(), "Frames of a run."},
          {"most_banks", from_one(), "The value of --banks."},
          {"allocations", from_one(), "Different allocations whose banks hold their buffers."},
          {"simulated", count(), "Runs of this command; the others were known, or ruled out."},
          {"best?", best,
           "Of the allocations that tie for the best of all, the fastest of those with the fewest banks. "
           "Allocations tie if none of them is known to be slower than another. Absent if none counts."},
          {"keeping?",
           object_of({{"least_percent", {{"type", "number"}, {"exclusiveMinimum", 0}, {"maximum", 100}}},
                      {"banks", from_one()},
                      {"percent", any_number(), "What these banks keep."}}),
           "The fewest banks that keep least_percent (--keep-fps) of the best rate. Absent if interrupted."},
          {"banks", list_of(banks), "For each number of banks that can hold the buffers."},
          {"equal_disparities?", object_of({{"allocations", from_one()}, {"frames", from_one()}}),
           "The disparities of the best allocation of each number of banks are the same. Absent if not "
           "compared."},
          {"first_failure?", text(), "The first allocation that could not be simulated, and why."},
          {"written?", text(), "The file of --write, if it was written."},
      });
  schema["description"] =
      "The best allocations of the buffers of a board to banks. Kinds of banks, clocks, priority and all "
      "other keys stay.";
  return schema;
}

Schema boards_schema() {
  const Schema board =
      object_of({{"name", text()}, {"description", text()}, {"file", text(), "the board file, YAML"}});
  return document_of("What `stereotlm boards --json` prints",
                     {{"boards", list_of(board, 1), "all presets, or that of --show"}});
}

Schema bounds_schema() {
  const Schema resource = object_of({
      {"resource", text(), "`port NAME`, `bank` or `matcher`"},
      {"banks?", names(), "of a bank: those that the frames use in turn"},
      {"cycles", from_one(), "the fewest cycles that it needs for a frame"},
      {"frames_per_second", above_zero()},
      {"headroom_percent", percentage(),
       "share of the time of a frame that the resource does not need; the time is that of the slowest "
       "resource"},
  });
  const Schema frames = object_of({
      {"frames", number_list(), "numbers of the frames, until the lists of the allocation begin anew"},
      {"buffers", list_of(object_of({{"name", text()}, {"banks", names()}}))},
      {"resources", list_of(resource, 1)},
  });
  const Schema limit = object_of(
      {{"resource", with_pattern("^(camera|pci|bridge|bank .+)$")}, {"frames_per_second", above_zero()}});
  const Schema bound = object_of({{"core", above_zero()},
                                  {"core_limited_by", text()},
                                  {"system", above_zero()},
                                  {"system_limited_by", text()}});
  const Schema bank_pins = object_of({{"bank", text()},
                                      {"data", from_one()},
                                      {"control", from_one()},
                                      {"address", count()},
                                      {"all", from_one()}});
  const Schema pins = object_of({
      {"banks", list_of(bank_pins, 1), "each bank that holds a word of a buffer"},
      {"local_bus", from_one()},
      {"other", from_one(), "clocks, reset and status"},
      {"all", from_one()},
  });
  return document_of("What `stereotlm bounds --json` prints",
                     {
                         {"board", text(), "name of the board"},
                         {"frames", list_of(frames, 1), "frames with equal bounds"},
                         {"computer", list_of(limit), "limits of the whole computer, with all masters"},
                         {"bound", bound, "frames per second over whole turns of the lists of buffers"},
                         {"area", area_document_schema()},
                         {"pins", pins, "of the FPGA"},
                     });
}

Schema check_schema() {
  const Schema problem = object_of({
      {"place", text(), "file:line:column, `--set KEY`, a preset, or `command line`"},
      {"key?", text()},
      {"value?", text(), "as written"},
      {"rule", text(), "the rule that is broken"},
      {"message", text(), "key, value and rule as in the text"},
      {"between_keys?", {{"const", true}}, "the rule involves several keys"},
  });
  Schema schema = document_of(
      "What `stereotlm check --json` prints",
      {
          {"board", {{"type", "string"}}, "BOARD as typed"},
          {"ok", truth()},
          {"problems", list_of(problem)},
          {"image?", object_of({{"width", from_one(), "pixels"}, {"height", from_one(), "pixels"}})},
          {"window?", from_one(), "rows and columns"},
          {"disparities?", from_one()},
          {"banks?", from_one()},
          {"clock_mhz?", above_zero()},
          {"device?", text()},
          {"fits?", truth(), "the core fits the device"},
          {"smallest_device?", text(), "that fits; absent if none does"},
          {"pins?", from_one(), "of the FPGA that the board takes"},
          {"values?", map_to({{"type", {"integer", "number", "string", "array", "object"}}}),
           "the value of each key, by its path; each bank has all its values"},
          {"preset?", text(),
           "BOARD if it is one, else the nearest: fewest values of --set make the board of it"},
          {"sets?", list_of(text()), "these: KEY=VALUE"},
      });
  schema["if"] = {{"properties", {{"ok", {{"const", true}}}}}};
  schema["then"] = {{"properties", {{"problems", {{"maxItems", 0}}}}},
                    {"required",
                     {"image", "window", "disparities", "banks", "clock_mhz", "device", "fits", "pins",
                      "values", "preset", "sets"}}};
  schema["else"] = {{"properties", {{"problems", {{"minItems", 1}}}}}};
  return schema;
}

Schema conflicts_schema() {
  Schema wait = object_of({
      {"port", text(), "who waits; the host by what it moves"},
      {"bank", text()},
      {"by", text(), "for whom, or `turnaround`, `row` or `refresh`"},
      {"cycles", from_one()},
      {"cycles_percent", amount()},
      {"before_first_row", truth(), "all of it is before the first row of results"},
      {"first_row?", count()},
      {"last_row?", count()},
      {"first_column?", count()},
      {"last_column?", count()},
  });
  require_together(wait, {"first_row", "last_row"});
  require_together(wait, {"first_column", "last_column"});
  wait["description"] =
      "rows and columns are those that have 80 % of the cycles; absent if that is most of the picture";
  const Schema bank = object_of(
      {{"name", text()}, {"accesses_percent", amount(), "of the cycles; with separate ports up to 200"}});
  Schema band = object_of({
      {"first_row?", count()},
      {"last_row?", count()},
      {"waits_percent", amount(), "of the cycles of these rows, of all ports"},
      {"banks", list_of(bank)},
  });
  require_together(band, {"first_row", "last_row"});
  return document_of(
      "What `stereotlm conflicts --json` prints",
      {
          {"board", text(), "name of the board"},
          {"frames", count()},
          {"cycles", count(), "of all frames"},
          {"waits", list_of(wait), "the most cycles first"},
          {"rows", list_of(band, 1), "from top to bottom; the first has no rows and is the fill"},
      });
}

Schema diff_schema() {
  Schema value = {{"type", {"number", "string"}}, {"description", "absent if the run has no such value"}};
  const Schema differing = list_of(object_of({{"path", text()}, {"a?", value}, {"b?", value}}));
  const Schema frame = object_of({{"frame", count()}, {"a", count()}, {"b", count()}});
  const Schema wait =
      object_of({{"port", text()}, {"bank", text()}, {"by", text()}, {"a", count()}, {"b", count()}});
  const Schema difference = {{"type", "integer"}};
  const Schema range = object_of({
      {"first_row", count()},
      {"last_row", count()},
      {"cycles", difference, "B - A, sum over the rows and frames"},
      {"waiting_cycles", map_to(difference), "of each port, likewise"},
  });
  const Schema rows = object_of({{"frames", count()}, {"ranges", list_of(range)}});
  const Schema disparities =
      object_of({{"frames", count()}, {"frames_that_differ", count()}, {"pixels_that_differ", count()}});
  return document_of(
      "What `stereotlm diff --json` prints",
      {
          {"a", text(), "folder"},
          {"b", text(), "folder"},
          {"settings", differing, "values of the board that differ"},
          {"options", differing, "values of run.json that differ"},
          {"figures", differing,
           "values of stats.json that differ, but frame_cycles, blame and what follows from others"},
          {"frames", list_of(frame), "frames of the core with other cycles"},
          {"waits", list_of(wait), "waits that differ, in cycles, the largest difference first"},
          {"rows", or_not_compared(rows), "rows of the picture that differ"},
          {"disparities", or_not_compared(disparities)},
          {"verdict", text(), "the last sentence of the text"},
      });
}

Schema explain_schema() {
  const Schema time = object_of({
      {"bound", amount(), "matcher and ports at their bound"},
      {"queues", any_number(), "queues and latencies of the core"},
      {"waits", any_number(), "ports wait for banks"},
      {"core_waits?", map_to(amount()),
       "the core waits for its next start, by the reason of timeline.csv; absent if it does not"},
  });
  const Schema resource = object_of({
      {"resource", text()},
      {"frames_per_second", above_zero(), "its bound"},
      {"headroom_percent",
       {{"type", "number"}, {"maximum", 100}},
       "share of the time of a frame that the resource does not need"},
      {"busy_percent", amount(), "measured share of the time in which the resource is used"},
      {"frame?", count(), "the frame with the least headroom; absent if all have the same"},
  });
  const Schema blame = object_of({
      {"port", with_pattern("^((left|right)_(lut|pixel)(\\.[0-9]+)?|result|host)$")},
      {"bank", text()},
      {"by", text(), "a port, `turnaround`, `row` or `refresh`"},
      {"cycles", from_one()},
      {"cycles_percent", amount(), "of the cycles of the frames"},
  });
  const auto change_with = [](const std::vector<Property>& more) {
    std::vector<Property> properties = {
        {"key", text(), "the key that changes, `a bank more` or `a bank less`"},
        {"from", text()},
        {"to", text()}};
    properties.insert(properties.end(), more.begin(), more.end());
    return list_of(object_of(properties));
  };
  const Schema changes = change_with({
      {"frames_per_second", above_zero()},
      {"gained_frames_per_second", any_number()},
      {"gained_percent", any_number()},
      {"memory_mj_per_frame", amount(), platform::kEnergyIsOf},
      {"memory_mj_changed_percent", any_number(), "of the energy of the board as it is"},
      {"changes_disparities", truth()},
      {"loses_pixels", truth()},
      {"sets", list_of({{"type", "string"}, {"minLength", 3}}, 1),
       "the values of `--set` that make the change, in place of earlier ones of the same key"},
      {"area", area_schema(), "of the changed board"},
      {"pins", from_one(), "of the FPGA"},
  });
  const Schema without_rate = change_with({{"reason", text()}});
  return document_of(
      "What `stereotlm explain --json` prints",
      {
          {"board", text(), "name of the board"},
          {"source", source()},
          {"frames", from_one(), "simulated"},
          {"frames_per_second", above_zero(), "of the core; with cameras in the long run"},
          {"uncertainty_frames_per_second?", amount(), "0 where the rate is proven; absent without cameras"},
          {"interrupted?", text(), "what was simulated; absent if all was"},
          {"limited_by", text(), "why the board is not faster, in words"},
          {"memory_mj_per_frame", amount(), platform::kEnergyIsOf},
          {"time_percent", time, "what the time of a frame goes to; the sum is 100"},
          {"loses_pixels", truth(), "captures lose pixels"},
          {"lost_pixels", count(), "the pixels that captures lose"},
          {"bound", object_of({{"frames_per_second", above_zero()}, {"limited_by", text()}})},
          {"result_queue_wait_percent?", percentage(),
           "share of the cycles in which the matcher waits for fpga.result_fifo_words; absent if it does not "
           "limit the board"},
          {"resources", list_of(resource, 1), "the least headroom first"},
          {"blame", list_of(blame), "who waits for whom, the most first"},
          {"area", area_schema(), "of the board as it is"},
          {"pins", from_one(), "of the FPGA"},
          {"changes", changes, "each single change, the best first; those that lose pixels after the others"},
          {"impossible", without_rate, "changes that another key or the tables forbid"},
          {"failed", without_rate, "changes whose simulation has failed"},
      });
}

Schema keys_schema() {
  const Schema key = object_of({
      {"key", text(), "its path; NAME stands for a bank's name"},
      {"meaning", text()},
      {"unit?", text(), "absent if the value has none"},
      {"range", text(), "the range or the allowed values, in words"},
  });
  const Schema figure = object_of({
      {"figure", text(), "a column of a sweep that is no key; NAME stands for that of a bank, port, .."},
      {"meaning", text()},
      {"unit?", text(), "absent if the value has none"},
  });
  Schema schema =
      document_of("What `stereotlm keys --json` prints",
                  {{"keys?", list_of(key, 1)}, {"figures?", list_of(figure, 1), "with --figures"}});
  schema["oneOf"] = {{{"required", {"keys"}}}, {{"required", {"figures"}}}};
  return schema;
}

Schema optimise_schema() {
  const Schema value = object_of({{"figure", text(), "the goal, as it was given"},
                                  {"least", any_number()},
                                  {"most", any_number(), "more than least only where a rate is uncertain"}});
  const Schema point = object_of({
      {"boards", from_one(), "Boards that have these values."},
      {"values", list_of(value, 1)},
      {"config", text(), "the first of these boards, as a board file"},
      {"command", text(), "the command that explains it"},
  });
  return document_of("What `stereotlm optimise --json` prints",
                     {
                         {"state", one_of_words({"complete", "interrupted"}),
                          "State of the search. interrupted: the front is that so far."},
                         {"boards", count(), "Boards of the space."},
                         {"combinations", from_one(), "Combinations of the values of the plan."},
                         {"front", list_of(point),
                          "The boards that no other board beats: none is at least as good in all goals and "
                          "better in one."},
                     });
}

const std::map<std::string, Schema (*)()>& schemas() {
  static const std::map<std::string, Schema (*)()> kSchemas = {
      {"allocate", allocate_schema}, {"boards", boards_schema},       {"bounds", bounds_schema},
      {"check", check_schema},       {"conflicts", conflicts_schema}, {"diff", diff_schema},
      {"explain", explain_schema},   {"keys", keys_schema},           {"optimise", optimise_schema},
      {"run", run_schema},
  };
  return kSchemas;
}

}  // namespace

std::vector<std::string> document_names() {
  std::vector<std::string> names;
  for (const auto& [name, schema] : schemas()) names.push_back(name);
  return names;
}

Schema document_schema(const std::string& command) { return schemas().at(command)(); }

}  // namespace stereotlm::stats
