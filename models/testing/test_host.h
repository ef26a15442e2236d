#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <systemc>
#include <tlm>
#include <utility>
#include <vector>

namespace stereotlm::test {

// An initiator under control of a test: words by b_transport, words and bursts by nb_transport, blocks by
// debug transport, and DMI. It ends each response of nb_transport by `ending`, and records the answer.
class TestHost : public sc_core::sc_module, public tlm::tlm_bw_transport_if<> {
 public:
  // The response to an access.
  struct Answer {
    tlm::tlm_response_status status = tlm::TLM_INCOMPLETE_RESPONSE;  // response of the target
    std::uint32_t word = 0;                                          // read, or written
    sc_core::sc_time at;                                             // absolute
    std::vector<std::uint32_t> words;                                // of a burst, `word` first
  };
  // The return value to BEGIN_RESP.
  enum class Ending { kCompleted, kUpdated, kAccepted };  // the return value to BEGIN_RESP

  tlm::tlm_initiator_socket<32> socket{"socket"};  // to the target
  Ending ending = Ending::kCompleted;              // of the responses to come
  std::vector<Answer> answers;                     // of nb_transport, in the order of their arrival
  std::vector<std::pair<sc_dt::uint64, sc_dt::uint64>> invalidations;  // first and last address of each

  // The socket must be bound to a target.
  explicit TestHost(const sc_core::sc_module_name& name) : sc_module(name) { socket.bind(*this); }

  // One word by b_transport, at now + delay.
  Answer read(std::uint64_t address, const sc_core::sc_time& delay = {}) {
    return block(tlm::TLM_READ_COMMAND, address, 0, delay);
  }
  Answer write(std::uint64_t address, std::uint32_t word, const sc_core::sc_time& delay = {}) {  // a word
    return block(tlm::TLM_WRITE_COMMAND, address, word, delay);
  }
  // Words by b_transport.
  Answer read_words(std::uint64_t address, std::size_t count) {
    return block(tlm::TLM_READ_COMMAND, address, std::vector<std::uint32_t>(count), {});
  }
  Answer write_words(std::uint64_t address, std::vector<std::uint32_t> words) {  // as read_words()
    return block(tlm::TLM_WRITE_COMMAND, address, std::move(words), {});
  }

  // Words by nb_transport, from now + delay on. Does not wait. Returns the target's return value. If the
  // target returns the response at once, it is recorded and, unless `ending` is kAccepted, ended.
  tlm::tlm_sync_enum request(tlm::tlm_command command, std::uint64_t address, std::uint32_t word = 0,
                             const sc_core::sc_time& delay = {}) {
    return request(command, address, std::vector<std::uint32_t>{word}, delay);
  }
  // As above, for a burst.
  tlm::tlm_sync_enum request(tlm::tlm_command command, std::uint64_t address,
                             std::vector<std::uint32_t> words, sc_core::sc_time delay = {});
  // Sends END_RESP for the last response, timed at that response, and returns what the target returns. For a
  // test whose `ending` is kAccepted.
  tlm::tlm_sync_enum end_response();
  // In a thread process: request(), and waits until the answer's time.
  Answer access(tlm::tlm_command command, std::uint64_t address, std::uint32_t word = 0) {
    return access(command, address, std::vector<std::uint32_t>{word});
  }
  // As above, for a burst.
  Answer access(tlm::tlm_command command, std::uint64_t address, std::vector<std::uint32_t> words);

  // Returns the number of bytes written.
  unsigned debug_write(std::uint64_t address, const std::vector<std::uint32_t>& words);
  // Returns the words that the target gave.
  std::vector<std::uint32_t> debug_read(std::uint64_t address, std::size_t count);
  bool dmi(std::uint64_t address, tlm::tlm_dmi& dmi);  // whether DMI is granted for a read at this address

  tlm::tlm_sync_enum nb_transport_bw(tlm::tlm_generic_payload& payload, tlm::tlm_phase& phase,
                                     sc_core::sc_time& delay) override;
  void invalidate_direct_mem_ptr(sc_dt::uint64 start, sc_dt::uint64 end) override {
    invalidations.emplace_back(start, end);
  }

 private:
  struct Transaction : tlm::tlm_generic_payload {
    Transaction(tlm::tlm_command command, std::uint64_t address, std::vector<std::uint32_t> data);
    std::vector<std::uint32_t> words;
    std::optional<Answer> answer;
  };
  // Transactions of nb_transport live as long as the host: a test may use them after their end.
  class Manager : public tlm::tlm_mm_interface {
    void free(tlm::tlm_generic_payload* /*payload*/) override {}
  };

  Answer block(tlm::tlm_command command, std::uint64_t address, std::uint32_t word,
               const sc_core::sc_time& delay) {
    return block(command, address, std::vector<std::uint32_t>{word}, delay);
  }
  Answer block(tlm::tlm_command command, std::uint64_t address, std::vector<std::uint32_t> words,
               sc_core::sc_time delay);
  static Answer answer_of(const Transaction& transaction, const sc_core::sc_time& delay);
  void record(tlm::tlm_generic_payload& payload, const sc_core::sc_time& delay);

  Manager manager_;
  std::deque<Transaction> transactions_;
  sc_core::sc_event answered_{"answered"};
};

}  // namespace stereotlm::test
