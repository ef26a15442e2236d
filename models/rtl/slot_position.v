// Where the slots that the filters take lie in the image. The pixel that leaves the filters is HALF columns
// and HALF rows before the slot: its column is the centre.
module slot_position #(
    parameter WIDTH = 640, parameter integer HEIGHT = 480, parameter SLOTS = 7,
    parameter integer FIRST_ROW = 0, parameter HALF = 3
) (
    input clk, input start, input enable,
    input last,  // slot of its column
    output reg [$clog2(WIDTH)-1:0] column, output [$clog2(WIDTH)-1:0] next_column,
    output reg [$clog2(WIDTH)-1:0] centre, output [$clog2(WIDTH)-1:0] next_centre,
    output is_below,  // the slot is below the image
    output centre_is_top,  // it is in row 0 of the strip of the centre
    // Bit i-1: column i before the centre, and column i behind it, is in the image.
    output reg [HALF-1:0] has_before, output reg [HALF-1:0] has_behind
);
  localparam COLUMN_BITS = $clog2(WIDTH);
  localparam ROW_BITS = $clog2(2 * HEIGHT + 4 * SLOTS + 4 * HALF + 4) + 1;
  localparam integer LAST_COLUMN = WIDTH - 1;
  localparam integer COLUMNS_BEFORE = (WIDTH - HALF % WIDTH) % WIDTH;  // column of the first centre
  localparam integer FIRST_CENTRE = FIRST_ROW - (HALF + WIDTH - 1) / WIDTH;
  localparam signed [ROW_BITS-1:0] HEIGHT_ROW = HEIGHT[ROW_BITS-1:0];

  reg signed [ROW_BITS-1:0] strip_row;  // of the first slot of each column
  reg signed [ROW_BITS-1:0] row;
  reg signed [ROW_BITS-1:0] centre_strip_row;
  reg signed [ROW_BITS-1:0] centre_row;
  wire ends_strip = column == LAST_COLUMN[COLUMN_BITS-1:0];
  wire centre_ends_strip = centre == LAST_COLUMN[COLUMN_BITS-1:0];
  wire signed [ROW_BITS-1:0] next_row = ends_strip ? strip_row + 1 : strip_row;
  wire signed [ROW_BITS-1:0] next_centre_row = centre_ends_strip ? centre_strip_row + 1 : centre_strip_row;
  integer i;

  assign next_column = ends_strip ? 0 : column + 1;
  assign next_centre = centre_ends_strip ? 0 : centre + 1;
  assign is_below = row >= HEIGHT_ROW;
  assign centre_is_top = centre_row == 0;
  always @* begin
    for (i = 1; i <= HALF; i = i + 1) begin
      has_before[i-1] = {{(32 - COLUMN_BITS) {1'b0}}, centre} >= i;
      has_behind[i-1] = {{(32 - COLUMN_BITS) {1'b0}}, centre} + i < WIDTH;
    end
  end

  always @(posedge clk) begin
    if (start) begin
      column <= 0;
      centre <= COLUMNS_BEFORE[COLUMN_BITS-1:0];
      strip_row <= FIRST_ROW[ROW_BITS-1:0];
      row <= FIRST_ROW[ROW_BITS-1:0];
      centre_strip_row <= FIRST_CENTRE[ROW_BITS-1:0];
      centre_row <= FIRST_CENTRE[ROW_BITS-1:0];
    end else if (enable && last) begin
      column <= next_column;
      centre <= next_centre;
      strip_row <= next_row;
      row <= next_row;
      centre_strip_row <= next_centre_row;
      centre_row <= next_centre_row;
    end else if (enable) begin
      row <= row + 1;
      centre_row <= centre_row + 1;
    end
  end
endmodule
