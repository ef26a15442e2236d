// The column and window modules (paper figures 6 and 8). Left pixels go to all column modules; right pixels
// are delayed by a column from each module to the next one.
module cost_array #(
    parameter WINDOW = 7, parameter DISPARITIES = 80, parameter COLUMN_BITS = 11, parameter SUM_BITS = 14,
    parameter DIFFERENCE_STAGES = 0,  // pipeline registers: behind the differences,
    parameter COLUMN_STAGES = 0,  // behind the sums of columns,
    parameter WINDOW_STAGES = 0  // behind the sums of windows
) (
    input clk, input enable, input [7:0] left, input [7:0] right,
    input first,  // slot of its column
    input last,
    input is_first,  // of window_control
    input has_old,
    output [SUM_BITS*DISPARITIES-1:0] sums  // [d]: of the window, with the last slot of a column
);
  wire [8*DISPARITIES-1:0] right_of;  // [d]
  wire [COLUMN_BITS*DISPARITIES-1:0] column_sums, entering;
  wire [SUM_BITS*DISPARITIES-1:0] window_sums;
  wire adds, adds_first;
  wire [2:0] of_difference;  // last, is_first, has_old
  wire window_enable, window_is_first, window_has_old;

  pipe #(.BITS(5), .STAGES(DIFFERENCE_STAGES)) difference_flags (
      .clk(clk), .in({enable, first, last, is_first, has_old}), .out({adds, adds_first, of_difference}));
  pipe #(.BITS(3), .STAGES(COLUMN_STAGES)) column_flags (
      .clk(clk), .in({adds && of_difference[2], of_difference[1:0]}),
      .out({window_enable, window_is_first, window_has_old}));
  pipe #(.BITS(COLUMN_BITS * DISPARITIES), .STAGES(COLUMN_STAGES)) column_pipe (
      .clk(clk), .in(column_sums), .out(entering));
  pipe #(.BITS(SUM_BITS * DISPARITIES), .STAGES(WINDOW_STAGES)) window_pipe (
      .clk(clk), .in(window_sums), .out(sums));

  assign right_of[7:0] = right;
  genvar d;
  generate
    for (d = 0; d < DISPARITIES; d = d + 1) begin : modules
      if (d > 0) begin : delayed
        delay_line #(.BITS(8), .DEPTH(WINDOW)) right_column (
            .clk(clk), .enable(enable), .in(right_of[8*(d-1)+:8]), .out(right_of[8*d+:8]));
      end
      column_module #(.SUM_BITS(COLUMN_BITS), .DIFFERENCE_STAGES(DIFFERENCE_STAGES)) column (
          .clk(clk), .left(left), .right(right_of[8*d+:8]), .enable(adds), .first(adds_first),
          .sum(column_sums[COLUMN_BITS*d+:COLUMN_BITS]));
      window_module #(.WINDOW(WINDOW), .COLUMN_BITS(COLUMN_BITS), .SUM_BITS(SUM_BITS)) window (
          .clk(clk), .enable(window_enable), .is_first(window_is_first), .has_old(window_has_old),
          .column_sum(entering[COLUMN_BITS*d+:COLUMN_BITS]), .sum(window_sums[SUM_BITS*d+:SUM_BITS]));
    end
  endgenerate
endmodule
