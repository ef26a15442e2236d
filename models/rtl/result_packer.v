// Packs the disparities of four columns to a word, the first one in the lowest byte (contract 1.5).
module result_packer (
    input clk, input enable, input [7:0] disparity,
    output [31:0] word  // that ends with this disparity
);
  reg [23:0] earlier;
  assign word = {disparity, earlier};
  always @(posedge clk) if (enable) earlier <= word[31:8];
endmodule
