// Select-min unit B (paper section 3.3), a binary tree of comparators: left-based matching. Of equal sums the
// smaller disparity wins. Pipeline registers follow the first STAGES levels.
module select_min_tree #(
    parameter DISPARITIES = 80, parameter SUM_BITS = 14, parameter STAGES = 0
) (
    input clk, input [SUM_BITS*DISPARITIES-1:0] sums, input [DISPARITIES-1:0] counts,
    output [7:0] disparity  // 255: no candidate
);
  localparam LEVELS = $clog2(DISPARITIES);
  localparam LEAVES = 1 << LEVELS;
  localparam KEY_BITS = SUM_BITS + 1;  // not a candidate, sum
  localparam NODE_BITS = KEY_BITS + 8;  // and its disparity

  genvar l;
  genvar n;
  generate
    for (l = 0; l <= LEVELS; l = l + 1) begin : level
      wire [NODE_BITS*(LEAVES>>l)-1:0] node, out;
      for (n = 0; n < LEAVES >> l; n = n + 1) begin : nodes
        if (l > 0) begin : inner
          wire [NODE_BITS-1:0] low = level[l-1].out[NODE_BITS*2*n+:NODE_BITS];
          wire [NODE_BITS-1:0] high = level[l-1].out[NODE_BITS*(2*n+1)+:NODE_BITS];
          assign node[NODE_BITS*n+:NODE_BITS] = high[NODE_BITS-1:8] < low[NODE_BITS-1:8] ? high : low;
        end else if (n < DISPARITIES) begin : leaf
          localparam [7:0] NUMBER = n;
          assign node[NODE_BITS*n+:NODE_BITS] = {!counts[n], sums[SUM_BITS*n+:SUM_BITS], NUMBER};
        end else begin : none
          assign node[NODE_BITS*n+:NODE_BITS] = {1'b1, {(NODE_BITS - 1) {1'b0}}};
        end
      end
      pipe #(.BITS(NODE_BITS * (LEAVES >> l)), .STAGES(l > 0 && l <= STAGES ? 1 : 0)) level_pipe (
          .clk(clk), .in(node), .out(out));
    end
  endgenerate
  wire [NODE_BITS-1:0] root = level[LEVELS].out;
  wire unused = |root[NODE_BITS-2:8];
  assign disparity = root[NODE_BITS-1] ? 8'd255 : root[7:0];
endmodule
