// A SystemC platform of somebody else: one module of its own in front of a bank of stereotlm.
#include <stereotlm/models/kernels/stereo.h>
#include <stereotlm/models/memory/ssram_bank.h>
#include <tlm_utils/simple_initiator_socket.h>

#include <cstdint>
#include <cstdio>
#include <systemc>

struct MyMaster : sc_core::sc_module {
  tlm_utils::simple_initiator_socket<MyMaster> port{"port"};

  SC_CTOR(MyMaster) { SC_THREAD(run); }

  sc_core::sc_time transport(tlm::tlm_command command, std::uint32_t& word) {
    tlm::tlm_generic_payload access;
    access.set_command(command);
    access.set_address(4);
    access.set_data_ptr(reinterpret_cast<unsigned char*>(&word));
    access.set_data_length(4);
    access.set_streaming_width(4);
    sc_core::sc_time delay;
    port->b_transport(access, delay);
    return delay;
  }

  void run() {
    std::uint32_t word = 0x12345678;
    transport(tlm::TLM_WRITE_COMMAND, word);
    word = 0;
    const sc_core::sc_time delay = transport(tlm::TLM_READ_COMMAND, word);
    // A pipelined ZBT SRAM at 40 MHz: two clocks of 25 ns.
    ok = word == 0x12345678 && delay == sc_core::sc_time(50, sc_core::SC_NS);
    std::printf("word %x after %s\n", word, delay.to_string().c_str());
  }

  bool ok = false;
};

int sc_main(int, char**) {
  MyMaster master("master");
  stereotlm::memory::SsramBank bank("bank", {});
  master.port.bind(bank.port);
  sc_core::sc_start();

  const stereotlm::kernels::GrayImage flat(64, 48, 100);
  const auto disparities = stereotlm::kernels::disparity_image(flat, flat, nullptr, nullptr, {});
  std::printf("the disparity of a flat pair is %d\n", disparities.at(32, 24));
  return master.ok && disparities.at(32, 24) == 0 ? 0 : 1;
}
