#include <cstdlib>
#include <exception>
#include <systemc>

#include "sw/cli/command.h"
#include "sw/process/problems.h"
#include "sw/process/streams.h"

namespace stereotlm::cli {
namespace {

std::string text_of(const sc_core::sc_report& report) {
  return std::string(report.get_msg_type()) + ": " + report.get_msg();
}

// Replaces SystemC's report handler, which prints to standard output. Warnings are printed on standard error;
// errors are thrown, as by default.
void handle_report(const sc_core::sc_report& report, const sc_core::sc_actions& actions) {
  if (report.get_severity() == sc_core::SC_WARNING) process::say("warning", text_of(report));
  sc_core::sc_report_handler::default_handler(
      report, actions & ~static_cast<sc_core::sc_actions>(sc_core::SC_DISPLAY));
}

int run_program(int argc, const char* const* argv) {
  try {
    return parse_command_line(argc, argv)();
  } catch (const process::Refused& refused) {
    for (const std::string& line : refused.lines()) process::say_line(line);
    return kRefused;
  } catch (const sc_core::sc_report& report) {
    process::say("error", "the model stopped: " + text_of(report));
  } catch (const std::exception& error) {
    process::say("error", error.what());
  }
  return kFailed;
}

}  // namespace
}  // namespace stereotlm::cli

int sc_main(int argc, char** argv) {
  sc_core::sc_report_handler::set_handler(stereotlm::cli::handle_report);
  stereotlm::process::prepare_streams();
  return stereotlm::cli::run_program(argc, argv);
}

// Replaces main() of libsystemc, which prints the copyright banner before sc_main can turn it off.
int main(int argc, char** argv) {
  setenv("SYSTEMC_DISABLE_COPYRIGHT_MESSAGE", "1", 1);
  return sc_core::sc_elab_and_sim(argc, argv);
}
