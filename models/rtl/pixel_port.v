`include "port_states.vh"

// Reads the pixel of each slot that it handles, and keeps it until the matcher consumes it (contract section
// 2, "Lane", rules 2 and 3). A slot that passes gives the pixel 0, not valid.
module pixel_port #(
    parameter FIFO_SLOTS = 16
) (
    input clk, input clear, input latency_2, input [2:0] state,
    input [1:0] byte_number,  // of the pixel in its word
    input granted,
    input [31:0] data,  // of the bank
    output handles,
    // The oldest pixel that is not consumed.
    output ready,
    output [8:0] pixel,  // valid bit, value
    input consumes
);
  wire arrives, valid;
  wire [1:0] number;
  assign handles = granted || state == `PORT_PASS;

  in_flight #(.BITS(3)) reads (
      .clk(clk), .clear(clear), .latency_2(latency_2), .send(handles),
      .in({state != `PORT_PASS, byte_number}), .arrives(arrives), .out({valid, number}));
  queue #(.BITS(9), .SLOTS(FIFO_SLOTS)) pixels (
      .clk(clk), .clear(clear), .push(arrives), .in(valid ? {1'b1, data[8*number+:8]} : 9'd0),
      .pop(consumes), .has_head(ready), .head(pixel));
endmodule
