// A column module (paper figure 8): the sum of absolute differences of the n pixel pairs of a column. The sum
// is there with the last pair.
module column_module #(
    parameter SUM_BITS = 11,
    parameter DIFFERENCE_STAGES = 0  // pipeline registers behind the difference
) (
    input clk, input [7:0] left, input [7:0] right,
    // Of the difference, behind its pipeline registers.
    input enable, input first, output [SUM_BITS-1:0] sum
);
  wire [7:0] difference = left > right ? left - right : right - left;
  wire [7:0] added;
  reg [SUM_BITS-1:0] sum_before;
  assign sum = (first ? 0 : sum_before) + {{(SUM_BITS - 8) {1'b0}}, added};

  pipe #(.BITS(8), .STAGES(DIFFERENCE_STAGES)) difference_pipe (.clk(clk), .in(difference), .out(added));
  always @(posedge clk) if (enable) sum_before <= sum;
endmodule
