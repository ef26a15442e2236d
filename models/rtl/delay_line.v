// A shift register that moves when `enable` is 1: `out` is the `in` of DEPTH moves before this one. It has no
// reset, so that look-up tables used as shift registers (SRL16) can hold it.
module delay_line #(
    parameter BITS = 8, parameter DEPTH = 1
) (
    input clk, input enable, input [BITS-1:0] in, output [BITS-1:0] out
);
  reg [DEPTH*BITS-1:0] stage;
  wire [DEPTH*BITS-1:0] next;
  assign {out, next} = {stage, in};
  always @(posedge clk) if (enable) stage <= next;
endmodule
