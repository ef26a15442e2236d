`include "port_states.vh"

// The queue of result words and the port that writes them, in the order of the buffer. A place of the queue
// is taken by `reserve`, and given back when its word is written.
module result_port #(
    parameter WORDS = 76800,  // of a frame
    parameter FIFO_WORDS = 8
) (
    input clk, input reset, input start, input [25:0] base, input reserve, output has_room,
    input enters,  // the port can write `word` from the next cycle on
    input [31:0] word, output [2:0] state, output [25:0] address, output [31:0] data,
    input granted,
    output done  // the last word is being written
);
  localparam WORD_BITS = $clog2(WORDS + 1);
  localparam COUNT_BITS = $clog2(FIFO_WORDS + 1);
  localparam PLACE_BITS = FIFO_WORDS == 1 ? 1 : $clog2(FIFO_WORDS);
  localparam integer LAST_WORD = WORDS - 1;
  localparam integer LAST = FIFO_WORDS - 1;

  reg [31:0] memory[0:FIFO_WORDS-1];
  reg [PLACE_BITS-1:0] first, free;
  reg [COUNT_BITS-1:0] queued, reserved;
  reg [WORD_BITS-1:0] written;

  assign has_room = reserved != FIFO_WORDS[COUNT_BITS-1:0];
  assign state = queued != 0 ? `PORT_REQUEST :
      written == 0 || written == WORDS[WORD_BITS-1:0] ? `PORT_IDLE : `PORT_STARVED;
  assign address = base + {{(26 - WORD_BITS) {1'b0}}, written};
  assign data = memory[first];
  assign done = granted && written == LAST_WORD[WORD_BITS-1:0];

  always @(posedge clk) begin
    if (enters) memory[free] <= word;
    if (reset || start) begin
      first <= 0;
      free <= 0;
      queued <= 0;
      reserved <= 0;
      written <= 0;
    end else begin
      if (enters) free <= free == LAST[PLACE_BITS-1:0] ? 0 : free + 1;
      if (granted) first <= first == LAST[PLACE_BITS-1:0] ? 0 : first + 1;
      if (granted) written <= written + 1;
      if (enters != granted) queued <= enters ? queued + 1 : queued - 1;
      if (reserve != granted) reserved <= reserve ? reserved + 1 : reserved - 1;
    end
  end
endmodule
