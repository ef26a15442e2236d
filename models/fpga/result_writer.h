#pragma once

#include <tlm_utils/simple_initiator_socket.h>

#include <array>
#include <cstdint>
#include <systemc>

#include "models/fpga/beats.h"
#include "models/fpga/core_config.h"
#include "models/fpga/placement.h"
#include "models/memory/word_access.h"
#include "models/stream.h"

namespace stereotlm::fpga {

// The result queue, and the port that writes its words to their places in the disparity buffer.
// CoreControl decides in which cycle a word is written.
class ResultWriter : public sc_core::sc_module {
 public:
  tlm_utils::simple_initiator_socket<ResultWriter> port{"port"};  // link to the banks

 private:
  void store(const ResultWord& word) {
    if (stored_ - written_ == fifo_words_) {
      SC_REPORT_ERROR("/stereotlm/result_writer", "a word arrives at a full queue");
      return;
    }
    words_[stored_++ % kRing] = word;
  }

 public:
  StreamIn<ResultWord, ResultWriter, &ResultWriter::store> words_in{"words_in", this};  // into the queue

  // `fifo_words`: depth of the queue. Throws std::invalid_argument outside kResultFifoRule.
  ResultWriter(const sc_core::sc_module_name& name, int fifo_words)
      : sc_module(name),
        fifo_words_(static_cast<std::size_t>(kResultFifoRule.required("result_fifo_words", fifo_words))) {}

  void start_frame(const Placement& disparities) {  // `disparities`: where the frame's results go
    disparities_ = disparities;
    stored_ = 0;
    written_ = 0;
  }
  // Writes the oldest word, in the cycle that is `at` from now.
  void write(const sc_core::sc_time& at) {
    if (written_ == stored_) {
      SC_REPORT_ERROR("/stereotlm/result_writer", "write: the queue is empty");
      return;
    }
    sc_core::sc_time delay = at;
    const ResultWord& word = words_[written_++ % kRing];
    const std::uint64_t row_words = disparities_.row_words();
    if (!access_.write(disparities_.address(word.place / row_words, word.place % row_words), word.word,
                       delay))
      ++errors_;
    ++writes_;
  }
  // The number of words written, over all frames, and of refused accesses among them, whose words are lost.
  std::uint64_t writes() const { return writes_; }
  std::uint64_t errors() const { return errors_; }

 private:
  static constexpr std::size_t kRing = kResultFifoRule.max;

  std::size_t fifo_words_;
  Placement disparities_;
  memory::WordAccess access_{port};
  std::array<ResultWord, kRing> words_{};
  std::size_t stored_ = 0;  // words since the start of the frame
  std::size_t written_ = 0;
  std::uint64_t writes_ = 0;
  std::uint64_t errors_ = 0;
};

}  // namespace stereotlm::fpga
