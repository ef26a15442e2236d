// What a port has asked of a bank, up to the cycle in which the bank answers: one or two cycles later.
module in_flight #(
    parameter BITS = 1
) (
    input clk, input clear,
    input latency_2,  // of the bank: 2 cycles, else 1
    input send, input [BITS-1:0] in, output arrives, output [BITS-1:0] out
);
  reg [1:0] sent;
  reg [BITS-1:0] data_1, data_2;
  assign arrives = latency_2 ? sent[1] : sent[0];
  assign out = latency_2 ? data_2 : data_1;

  always @(posedge clk) begin
    sent   <= clear ? 2'b00 : {sent[0], send};
    data_1 <= in;
    data_2 <= data_1;
  end
endmodule
