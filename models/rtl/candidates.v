// Which disparities of a column have windows that lie inside both images. The right window of disparity d is
// that of d columns before, in the same row.
module candidates #(
    parameter DISPARITIES = 80
) (
    input clk, input start, input enable,
    input is_inside,  // of window_control
    input ends_row,
    output [DISPARITIES-1:0] counts  // [d]
);
  reg [DISPARITIES-1:0] earlier;  // bit d-1: the window of d columns before lies inside
  wire [DISPARITIES-1:0] right_inside;
  wire unused;
  assign {unused, right_inside} = {earlier, is_inside};
  assign counts = is_inside ? right_inside : 0;
  always @(posedge clk) begin
    if (start) earlier <= 0;
    else if (enable) earlier <= ends_row ? 0 : right_inside;
  end
endmodule
