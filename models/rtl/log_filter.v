// The filter of one side (paper section 2.4, contract 1.2). With each slot leaves the filtered pixel that is
// HALF columns and HALF rows before it. A block RAM has a word for each column of the image: the 2 * HALF
// rows above the strip. SIZE columns lie in shift registers, each as long as a column. A window of SIZE by
// SIZE pixels moves down the column with each slot. Pixels beyond an edge of the image repeat the edge.
module log_filter #(
    parameter WIDTH = 640, parameter SLOTS = 7, parameter HALF = 3, parameter SHIFT = 6,
    parameter [16*(2*HALF+1)*(2*HALF+1)-1:0] WEIGHTS = 0,  // row-major, the first one in the lowest bits
    parameter WINDOW_STAGES = 0,  // pipeline registers: behind the window,
    parameter ROW_STAGES = 0,  // behind the sums of its rows,
    parameter SUM_STAGES = 0  // behind the filtered pixel
) (
    input clk, input enable,
    input first,  // slot of its column
    input last,
    input [8:0] pixel,  // valid bit, value
    // Of slot_position.
    input [$clog2(WIDTH)-1:0] column, input [$clog2(WIDTH)-1:0] next_column, input is_top, input is_below,
    input centre_is_top, input [HALF-1:0] has_before, input [HALF-1:0] has_behind,
    output [8:0] filtered  // the valid bit is that of the pixel in the same place
);
  localparam SIZE = 2 * HALF + 1;
  localparam ABOVE = 2 * HALF;  // rows
  localparam SUM_BITS = sum_bits(0);

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
  function signed [SUM_BITS-1:0] weight(input integer place);
    weight = {{(SUM_BITS - 16) {WEIGHTS[16*place+15]}}, WEIGHTS[16*place+:16]};
  endfunction

  reg [9*ABOVE-1:0] lines[0:WIDTH-1];  // [column]: the rows above, the uppermost in the lowest bits
  reg [9*ABOVE-1:0] above;  // those of the column that enters
  reg [9*ABOVE*ABOVE-1:0] above_before;  // those of the columns before it, the last one in the lowest bits
  reg [9*SIZE*ABOVE-1:0] held;  // the lower rows of the window of the slot before: [row][tap]
  reg [8:0] pixel_before;
  wire [8:0] entering = !is_below ? pixel : first ? above[9*(ABOVE-1)+:9] : pixel_before;

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

  // The window: [row][tap], row 0 above.
  wire [9*SIZE*ABOVE-1:0] all_above = {above_before, above};  // [tap][row]
  reg [9*SIZE*SIZE-1:0] window;
  reg [9*SIZE*SIZE-1:0] repeated;  // its edges repeated
  integer r;
  integer c;
  always @* begin
    window = {tap, held};
    for (r = 0; r < ABOVE; r = r + 1)
      for (c = 0; c < SIZE; c = c + 1)
        if (centre_is_top) window[9*(SIZE*r+c)+:9] = tap[9*c+:9];
        else if (first) window[9*(SIZE*r+c)+:9] = all_above[9*(ABOVE*c+r)+:9];
    repeated = window;
    for (r = 0; r < SIZE; r = r + 1)
      for (c = 1; c <= HALF; c = c + 1) begin
        if (!has_before[c-1]) repeated[9*(SIZE*r+HALF+c)+:9] = repeated[9*(SIZE*r+HALF+c-1)+:9];
        if (!has_behind[c-1]) repeated[9*(SIZE*r+HALF-c)+:9] = repeated[9*(SIZE*r+HALF-c+1)+:9];
      end
  end

  always @(posedge clk) begin
    if (enable) begin
      pixel_before <= entering;
      held <= window[9*SIZE*SIZE-1:9*SIZE];
      if (first) begin
        above_before <= all_above[9*ABOVE*ABOVE-1:0];
        lines[column] <= is_top ? {ABOVE{entering}} : {entering, above[9*ABOVE-1:9]};
      end
      if (last) above <= lines[next_column];
    end
  end

  wire [9*SIZE*SIZE-1:0] pixels;
  pipe #(.BITS(9 * SIZE * SIZE), .STAGES(WINDOW_STAGES)) window_pipe (
      .clk(clk), .in(repeated), .out(pixels));

  reg [SUM_BITS*SIZE-1:0] row_sum;
  wire [SUM_BITS*SIZE-1:0] row_sums;
  integer row;
  integer n;
  always @* begin
    row_sum = 0;
    for (row = 0; row < SIZE; row = row + 1)
      for (n = 0; n < SIZE; n = n + 1)
        row_sum[SUM_BITS*row+:SUM_BITS] = row_sum[SUM_BITS*row+:SUM_BITS] +
            weight(SIZE * row + SIZE - 1 - n) * {{(SUM_BITS - 8) {1'b0}}, pixels[9*(SIZE*row+n)+:8]};
  end
  wire centre_valid;
  pipe #(.BITS(SUM_BITS * SIZE + 1), .STAGES(ROW_STAGES)) row_pipe (
      .clk(clk), .in({pixels[9*(SIZE*HALF+HALF)+8], row_sum}), .out({centre_valid, row_sums}));

  reg signed [SUM_BITS:0] sum;
  integer s;
  always @* begin
    sum = 0;
    for (s = 0; s < SIZE; s = s + 1)
      sum = sum + {row_sums[SUM_BITS*s+SUM_BITS-1], row_sums[SUM_BITS*s+:SUM_BITS]};
  end
  wire signed [SUM_BITS:0] level = (sum >>> SHIFT) + 128;
  wire [7:0] value = level < 0 ? 8'd0 : level > 255 ? 8'd255 : level[7:0];
  pipe #(.BITS(9), .STAGES(SUM_STAGES)) sum_pipe (.clk(clk), .in({centre_valid, value}), .out(filtered));
endmodule
