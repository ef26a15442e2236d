// Pipeline registers: `out` is `in` STAGES cycles later. With 0 stages it is a wire.
module pipe #(
    parameter BITS = 1, parameter STAGES = 0
) (
    input clk, input [BITS-1:0] in, output [BITS-1:0] out
);
  generate
    if (STAGES == 0) begin : wires
      wire unused = clk;
      assign out = in;
    end else begin : registers
      reg [STAGES*BITS-1:0] stage;
      wire [BITS-1:0] leaving;
      wire [STAGES*BITS-1:0] next;
      assign {leaving, next} = {stage, in};
      assign out = leaving;
      always @(posedge clk) stage <= next;
    end
  endgenerate
endmodule
