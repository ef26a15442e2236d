#include <malloc.h>

#include <cstdlib>
#include <systemc>

#include "sw/cli/command.h"
#include "sw/process/streams.h"

namespace stereotlm::cli {
namespace {

// Replaces SystemC's report handler, which prints to standard output. Warnings are printed on standard error;
// errors are thrown, as by default.
void handle_report(const sc_core::sc_report& report, const sc_core::sc_actions& actions) {
  if (report.get_severity() == sc_core::SC_WARNING)
    process::say("warning", std::string(report.get_msg_type()) + ": " + report.get_msg());
  sc_core::sc_report_handler::default_handler(
      report, actions & ~static_cast<sc_core::sc_actions>(sc_core::SC_DISPLAY));
}

}  // namespace
}  // namespace stereotlm::cli

int sc_main(int argc, char** argv) {
  sc_core::sc_report_handler::set_handler(stereotlm::cli::handle_report);
  stereotlm::process::prepare_streams();
  return stereotlm::cli::execute(argc, argv);
}

// Replaces main() of libsystemc, which prints the copyright banner before sc_main can turn it off.
int main(int argc, char** argv) {
  // Boards that are simulated one after the other use the same memory again. A frame of the core alone then
  // takes a quarter of the time, because no page is new to the process.
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_TRIM_THRESHOLD, 256 << 20);
  setenv("SYSTEMC_DISABLE_COPYRIGHT_MESSAGE", "1", 1);
  return sc_core::sc_elab_and_sim(argc, argv);
}
