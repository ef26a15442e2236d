`include "port_states.vh"

// Reads the table entry of each slot that the lane takes (contract section 2, "Lane", rules 1 and 2). Empty
// slots pass, with an entry that is not valid.
module table_port #(
    parameter FIFO_SLOTS = 16
) (
    input clk, input clear, input latency_2, input [2:0] take_state, input granted,
    input [31:0] data,  // of the bank
    output takes,
    // The oldest entry that is not handled.
    output has_entry,
    output [22:0] entry,  // valid bit, row, column
    input handles
);
  wire arrives, passed;
  wire [22:0] arriving = passed ? 23'd0 : {data[31], data[26:16], data[10:0]};
  wire unused = &{data[30:27], data[15:11]};
  assign takes = granted || take_state == `PORT_PASS;

  in_flight #(.BITS(1)) reads (
      .clk(clk), .clear(clear), .latency_2(latency_2), .send(takes), .in(take_state == `PORT_PASS),
      .arrives(arrives), .out(passed));
  queue #(.BITS(23), .SLOTS(FIFO_SLOTS)) entries (
      .clk(clk), .clear(clear), .push(arrives), .in(arriving), .pop(handles), .has_head(has_entry),
      .head(entry));
endmodule
