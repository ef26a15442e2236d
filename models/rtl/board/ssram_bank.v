// A bank of synchronous SRAM, for simulation. A word that is read comes one or two cycles after its address.
// In all other cycles the bank gives 32'hbad0bad0. At first it holds banks/NUMBER.hex.
module ssram_bank #(
    parameter integer WORDS = 524288, parameter LATENCY_2 = 1, parameter [15:0] NUMBER = "00"
) (
    input clk, input enable, input write, input [25:0] address, input [31:0] write_data,
    output [31:0] read_data
);
  localparam WORD_BITS = WORDS == 1 ? 1 : $clog2(WORDS);

  reg [31:0] words[0:WORDS-1];
  reg [31:0] read_1, read_2;  // one and two cycles ago
  wire is_inside = {6'd0, address} < WORDS;
  assign read_data = LATENCY_2 != 0 ? read_2 : read_1;

  initial $readmemh({"banks/", NUMBER, ".hex"}, words);

  always @(posedge clk) begin
    if (enable && write && is_inside) words[address[WORD_BITS-1:0]] <= write_data;
    read_1 <= enable && !write && is_inside ? words[address[WORD_BITS-1:0]] : 32'hbad0bad0;
    read_2 <= read_1;
  end
endmodule
