// A window module (paper figure 8): adds the sum of the new column and subtracts that of n columns before,
// which a shift register keeps.
module window_module #(
    parameter WINDOW = 7, parameter COLUMN_BITS = 11, parameter SUM_BITS = 14
) (
    input clk, input enable,
    input is_first,  // column of the frame: the sum before it counts as 0
    input has_old,  // n columns of the frame or more have come before
    input [COLUMN_BITS-1:0] column_sum, output [SUM_BITS-1:0] sum
);
  wire [COLUMN_BITS-1:0] old;
  wire [COLUMN_BITS-1:0] leaving = has_old ? old : 0;
  reg [SUM_BITS-1:0] sum_before;
  assign sum = (is_first ? 0 : sum_before) + {{(SUM_BITS - COLUMN_BITS) {1'b0}}, column_sum} -
      {{(SUM_BITS - COLUMN_BITS) {1'b0}}, leaving};

  delay_line #(.BITS(COLUMN_BITS), .DEPTH(WINDOW)) columns (
      .clk(clk), .enable(enable), .in(column_sum), .out(old));
  always @(posedge clk) if (enable) sum_before <= sum;
endmodule
