#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace stereotlm::cli {

// Executes the command that was parsed and returns the exit status. Throws Refused if the command cannot be
// done; it has then had no effect.
using Action = std::function<int()>;

// Each function adds one command to the program. Parsing sets `action` if the command line has that command,
// and throws Refused if its options are wrong.
void add_run(CLI::App& program, Action& action);
void add_check(CLI::App& program, Action& action);
void add_boards(CLI::App& program, Action& action);
void add_keys(CLI::App& program, Action& action);
void add_bounds(CLI::App& program, Action& action);
void add_explain(CLI::App& program, Action& action);
void add_calibrate(CLI::App& program, Action& action);
void add_allocate(CLI::App& program, Action& action);
void add_sweep(CLI::App& program, Action& action);
void add_merge(CLI::App& program, Action& action);
void add_plot(CLI::App& program, Action& action);
void add_conflicts(CLI::App& program, Action& action);
void add_diagram(CLI::App& program, Action& action);
void add_diff(CLI::App& program, Action& action);
void add_report(CLI::App& program, Action& action);
void add_paper(CLI::App& program, Action& action);

}  // namespace stereotlm::cli
