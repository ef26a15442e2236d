// The left-right check (paper section 2.3, contract 1.4). The left-based match of a column waits for D-1
// columns. Then the right-based match of the right pixel that it points to is at most D-1 columns old.
module lr_check #(
    parameter DISPARITIES = 80, parameter HAS_CHECK = 1, parameter integer TOLERANCE = 0
) (
    input clk, input enable,
    input [7:0] left_based,  // of unit B; 255: none
    input left_valid,  // valid bit of the left pixel
    input [7:0] right_based,  // of unit A, of the right pixel D-1 columns before
    output [7:0] disparity  // of the left pixel D-1 columns before; 255: it failed
);
  localparam PLACE_BITS = DISPARITIES == 1 ? 1 : $clog2(DISPARITIES);
  localparam integer DELAY = DISPARITIES - 1;
  reg [7:0] left_memory[0:(1<<PLACE_BITS)-1];
  reg [7:0] right_memory[0:(1<<PLACE_BITS)-1];
  reg [PLACE_BITS-1:0] now = 0;
  wire [PLACE_BITS-1:0] left_place = now - DELAY[PLACE_BITS-1:0];
  wire [7:0] entering = left_valid ? left_based : 8'd255;
  wire [7:0] left = DISPARITIES == 1 ? entering : left_memory[left_place];
  wire [PLACE_BITS-1:0] right_place = now - left[PLACE_BITS-1:0];
  wire [7:0] right = left == 0 ? right_based : right_memory[right_place];
  wire [7:0] difference = left > right ? left - right : right - left;
  wire passes = HAS_CHECK == 0 || (right != 255 && difference <= TOLERANCE[7:0]);
  assign disparity = passes ? left : 8'd255;

  always @(posedge clk) begin
    if (enable) begin
      left_memory[now] <= entering;
      right_memory[now] <= right_based;
      now <= now + 1;
    end
  end
endmodule
