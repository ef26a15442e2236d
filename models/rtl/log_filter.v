// The filter of one side (paper section 2.4, contract 1.2). With each slot leaves the filtered pixel that is
// HALF columns and HALF rows before it: its column is the centre. SIZE columns lie in shift registers, each
// as long as a column. With each slot they give a row of the window, which gives a sum for each row of the
// kernel. Partial result i has rows 0..i of the kernel. With the next slot below it becomes partial result
// i+1. A block RAM keeps, for the strip below, the partial results of each column behind the first slot of
// the strip. Pixels beyond an edge of the image repeat the edge.
module log_filter #(
    parameter WIDTH = 640, parameter SLOTS = 7, parameter HALF = 3, parameter SHIFT = 6,
    parameter [16*(2*HALF+1)*(2*HALF+1)-1:0] WEIGHTS = 0,  // row-major, the first one in the lowest bits
    parameter WINDOW_STAGES = 0,  // pipeline registers: behind the row of the window,
    parameter ROW_STAGES = 0,  // behind its sums,
    parameter SUM_STAGES = 0  // behind the filtered pixel
) (
    input clk, input enable,
    input first,  // slot of its column
    input last,
    input [8:0] pixel,  // valid bit, value
    // Of slot_position.
    input [$clog2(WIDTH)-1:0] column, input [$clog2(WIDTH)-1:0] next_column,
    input [$clog2(WIDTH)-1:0] centre, input [$clog2(WIDTH)-1:0] next_centre, input is_below,
    input centre_is_top, input [HALF-1:0] has_before, input [HALF-1:0] has_behind,
    output [8:0] filtered  // the valid bit is that of the pixel in the same place
);
  localparam SIZE = 2 * HALF + 1;
  localparam COLUMN_BITS = $clog2(WIDTH);
  localparam SUM_BITS = sum_bits(0);
  localparam HELD_BITS = SUM_BITS * (SIZE - 1) + HALF;
  localparam IS_SYMMETRIC = is_symmetric(0);

  // Enough for all partial sums: the positive weights sum to as much as the negative ones.
  function integer sum_bits(input integer unused);
    reg [39:0] most;
    integer n;
    begin
      most = 0;
      for (n = 0; n < SIZE * SIZE; n = n + 1)
        if (!WEIGHTS[16*n+15]) most = most + 255 * {24'd0, WEIGHTS[16*n+:16]};
      sum_bits = 17 + (unused & 0);
      for (n = 16; n < 40; n = n + 1) if (most[n]) sum_bits = n + 2;
    end
  endfunction
  // Whether both halves of each row are equal. Then pixels of equal weight are added first.
  function integer is_symmetric(input integer unused);
    integer n;
    integer m;
    begin
      is_symmetric = 1 + (unused & 0);
      for (n = 0; n < SIZE; n = n + 1)
        for (m = 0; m < HALF; m = m + 1)
          if (WEIGHTS[16*(SIZE*n+m)+:16] != WEIGHTS[16*(SIZE*n+SIZE-1-m)+:16]) is_symmetric = 0;
    end
  endfunction
  function [SUM_BITS-1:0] magnitude(input integer place);
    magnitude = {{(SUM_BITS - 16) {1'b0}},
                 WEIGHTS[16*place+15] ? -WEIGHTS[16*place+:16] : WEIGHTS[16*place+:16]};
  endfunction

  // Below the image the last row repeats. The row above the strip is that of the column which enters.
  reg [8:0] last_row[0:WIDTH-1];  // [column]
  reg [8:0] above;
  reg [8:0] pixel_before;
  wire [8:0] entering = !is_below ? pixel : first ? above : pixel_before;
  always @(posedge clk) begin
    if (enable) begin
      pixel_before <= entering;
      if (first) last_row[column] <= entering;
      if (last) above <= last_row[next_column];
    end
  end

  // Tap t is the slot's row in column t before the one that enters.
  wire [9*SIZE-1:0] tap;
  assign tap[8:0] = entering;
  genvar t;
  generate
    for (t = 1; t < SIZE; t = t + 1) begin : columns
      delay_line #(.BITS(9), .DEPTH(SLOTS)) column_before (
          .clk(clk), .enable(enable), .in(tap[9*(t-1)+:9]), .out(tap[9*t+:9]));
    end
  endgenerate
  reg [8*SIZE-1:0] repeated;  // the row of the window, its edges repeated
  integer c;
  always @* begin
    for (c = 0; c < SIZE; c = c + 1) repeated[8*c+:8] = tap[9*c+:8];
    for (c = 1; c <= HALF; c = c + 1) begin
      if (!has_before[c-1]) repeated[8*(HALF+c)+:8] = repeated[8*(HALF+c-1)+:8];
      if (!has_behind[c-1]) repeated[8*(HALF-c)+:8] = repeated[8*(HALF-c+1)+:8];
    end
  end

  wire [8*SIZE-1:0] pixels;
  pipe #(.BITS(8 * SIZE), .STAGES(WINDOW_STAGES)) window_pipe (.clk(clk), .in(repeated), .out(pixels));
  reg [SUM_BITS-1:0] term;
  reg [SUM_BITS*SIZE-1:0] row_sum;
  integer row;
  integer n;
  always @* begin
    row_sum = 0;
    term = 0;
    for (row = 0; row < SIZE; row = row + 1)
      for (n = 0; n < SIZE - (IS_SYMMETRIC != 0 ? HALF : 0); n = n + 1) begin
        term = {{(SUM_BITS - 8) {1'b0}}, pixels[8*n+:8]};
        if (IS_SYMMETRIC != 0 && n < HALF) term = term + {{(SUM_BITS - 8) {1'b0}}, pixels[8*(SIZE-1-n)+:8]};
        term = magnitude(SIZE * row + SIZE - 1 - n) * term;
        row_sum[SUM_BITS*row+:SUM_BITS] = WEIGHTS[16*(SIZE*row+SIZE-1-n)+15] ?
            row_sum[SUM_BITS*row+:SUM_BITS] - term : row_sum[SUM_BITS*row+:SUM_BITS] + term;
      end
  end

  // Behind the row sums.
  wire [SUM_BITS*SIZE-1:0] sums;
  wire adds, adds_first, adds_last, adds_top, adds_valid;
  wire [COLUMN_BITS-1:0] at, next_at;
  pipe #(.BITS(SUM_BITS * SIZE), .STAGES(ROW_STAGES)) row_pipe (.clk(clk), .in(row_sum), .out(sums));
  pipe #(.BITS(5 + 2 * COLUMN_BITS), .STAGES(WINDOW_STAGES + ROW_STAGES)) row_flags (
      .clk(clk), .in({enable, first, last, centre_is_top, tap[9*HALF+8], centre, next_centre}),
      .out({adds, adds_first, adds_last, adds_top, adds_valid, at, next_at}));

  reg [HELD_BITS-1:0] lines[0:WIDTH-1];  // [column]
  reg [HELD_BITS-1:0] line, held;
  wire [HELD_BITS-1:0] previous = adds_first ? line : held;
  reg [SUM_BITS*SIZE-1:0] partial;
  // [rows above the slot]: valid bit of the centre's column.
  wire [HALF:0] valid = {previous[HELD_BITS-1:SUM_BITS*(SIZE-1)], adds_valid};
  integer i;
  always @* begin
    // In row 0 all rows above are equal to it. What is beyond the middle then belongs to no row of the image.
    partial = sums;
    for (i = 1; i < SIZE; i = i + 1)
      partial[SUM_BITS*i+:SUM_BITS] = sums[SUM_BITS*i+:SUM_BITS] +
          (adds_top && i <= HALF ? partial[SUM_BITS*(i-1)+:SUM_BITS] : previous[SUM_BITS*(i-1)+:SUM_BITS]);
  end
  always @(posedge clk) begin
    if (adds) begin
      held <= {valid[HALF-1:0], partial[SUM_BITS*(SIZE-1)-1:0]};
      if (adds_first) lines[at] <= {valid[HALF-1:0], partial[SUM_BITS*(SIZE-1)-1:0]};
      if (adds_last) line <= lines[next_at];
    end
  end

  wire signed [SUM_BITS:0] sum = {partial[SUM_BITS*SIZE-1], partial[SUM_BITS*(SIZE-1)+:SUM_BITS]};
  wire signed [SUM_BITS:0] level = (sum >>> SHIFT) + 128;
  wire [7:0] value = level < 0 ? 8'd0 : level > 255 ? 8'd255 : level[7:0];
  pipe #(.BITS(9), .STAGES(SUM_STAGES)) sum_pipe (.clk(clk), .in({valid[HALF], value}), .out(filtered));
endmodule
