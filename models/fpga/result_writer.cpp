#include "models/fpga/result_writer.h"

#include "models/fpga/core_ports.h"

namespace stereotlm::fpga {

ResultWriter::ResultWriter(const sc_core::sc_module_name& name, int fifo_words)
    : sc_module(name),
      fifo_words_(static_cast<std::size_t>(kResultFifoRule.required("result_fifo_words", fifo_words))) {}

void ResultWriter::start_frame(std::uint64_t disparity_address) {
  disparity_address_ = disparity_address;
  stored_ = 0;
  written_ = 0;
}

void ResultWriter::store(const ResultWord& word) {
  if (stored_ - written_ == fifo_words_) {
    SC_REPORT_ERROR("/stereotlm/result_writer", "a word arrives at a full queue");
    return;
  }
  words_[stored_++ % kRing] = word;
}

void ResultWriter::write(const sc_core::sc_time& at) {
  if (written_ == stored_) {
    SC_REPORT_ERROR("/stereotlm/result_writer", "write: the queue is empty");
    return;
  }
  sc_core::sc_time delay = at;
  const ResultWord& word = words_[written_++ % kRing];
  if (!access_.write(disparity_address_ + result_word_offset(word.place), word.word, delay)) ++errors_;
  ++writes_;
}

}  // namespace stereotlm::fpga
