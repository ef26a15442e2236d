// Select-min unit A (paper section 3.3), the serial chain of comparators: right-based matching. Module d
// compares what module d-1 held a column before with the sum of disparity d. It keeps the smaller sum, and of
// equal sums that of module d-1. With each column the match of the right pixel D-1 columns before leaves.
module select_min_chain #(
    parameter DISPARITIES = 80, parameter SUM_BITS = 14
) (
    input clk, input clear, input enable, input [SUM_BITS*DISPARITIES-1:0] sums,
    input [DISPARITIES-1:0] counts,
    output [7:0] disparity  // 255: no candidate
);
  localparam integer LAST = DISPARITIES - 1;
  reg [DISPARITIES:0] valid;  // [d+1]: of module d; before module 0 there is no candidate
  reg [SUM_BITS*(DISPARITIES+1)-1:0] held;
  reg [8*(DISPARITIES+1)-1:0] number;
  reg [DISPARITIES-1:0] takes;
  wire [7:0] before_last = valid[DISPARITIES-1] ? number[8*(DISPARITIES-1)+:8] : 8'd255;
  integer d;
  integer m;

  assign disparity = takes[DISPARITIES-1] ? LAST[7:0] : before_last;
  always @* begin
    for (d = 0; d < DISPARITIES; d = d + 1)
      takes[d] = counts[d] && (!valid[d] || sums[SUM_BITS*d+:SUM_BITS] < held[SUM_BITS*d+:SUM_BITS]);
  end
  always @(posedge clk) begin
    valid[0] <= 0;
    held[SUM_BITS-1:0] <= 0;
    number[7:0] <= 0;
    if (clear) valid[DISPARITIES:1] <= 0;
    else if (enable) begin
      for (m = 0; m < DISPARITIES; m = m + 1) begin
        valid[m+1] <= valid[m] || takes[m];
        held[SUM_BITS*(m+1)+:SUM_BITS] <=
            takes[m] ? sums[SUM_BITS*m+:SUM_BITS] : held[SUM_BITS*m+:SUM_BITS];
        number[8*(m+1)+:8] <= takes[m] ? m[7:0] : number[8*m+:8];
      end
    end
  end
endmodule
