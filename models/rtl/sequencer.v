// The slots of one lane, in their order (contract section 2, "Slots"): strips from above to below, columns
// from left to right, SLOTS rows down each column. The next strip begins one row further down.
module sequencer #(
    parameter integer WIDTH = 640, parameter integer HEIGHT = 480,
    parameter SLOTS = 7,       // of a column
    parameter integer FIRST_ROW = -3,  // row of the first slot
    parameter integer STRIPS = 480, parameter PLACE_BITS = 19
) (
    input clk, input reset, input start,
    input advance,  // to the next slot
    output reg [PLACE_BITS-1:0] place,  // of the slot: row * WIDTH + column; without meaning if it is empty
    output empty,  // its row is outside the image
    output done  // the last slot is taken
);
  localparam K_BITS = $clog2(SLOTS + 1);
  localparam COLUMN_BITS = $clog2(WIDTH);
  localparam ROW_BITS = $clog2(HEIGHT + STRIPS + SLOTS) + 1;
  localparam STRIP_BITS = $clog2(STRIPS + 1);
  localparam signed [ROW_BITS-1:0] FIRST = FIRST_ROW[ROW_BITS-1:0];
  localparam signed [ROW_BITS-1:0] HEIGHT_ROW = HEIGHT[ROW_BITS-1:0];
  localparam integer LAST_SLOT = SLOTS - 1;
  localparam integer LAST_COLUMN = WIDTH - 1;
  localparam integer FIRST_PLACE = FIRST_ROW * WIDTH;

  reg [K_BITS-1:0] k;
  reg [COLUMN_BITS-1:0] column;
  reg [STRIP_BITS-1:0] strip;
  reg signed [ROW_BITS-1:0] strip_row;  // of the first slot of each column of the strip
  reg signed [ROW_BITS-1:0] row;
  reg [PLACE_BITS-1:0] column_place;  // of the first slot of the column

  wire last_slot = k == LAST_SLOT[K_BITS-1:0];
  wire last_column = column == LAST_COLUMN[COLUMN_BITS-1:0];
  wire signed [ROW_BITS-1:0] next_strip_row = last_column ? strip_row + 1 : strip_row;
  assign empty = row < 0 || row >= HEIGHT_ROW;
  assign done = strip == STRIPS[STRIP_BITS-1:0];

  always @(posedge clk) begin
    if (start) begin
      k <= 0;
      column <= 0;
      strip <= 0;
      strip_row <= FIRST;
      row <= FIRST;
      column_place <= FIRST_PLACE[PLACE_BITS-1:0];
      place <= FIRST_PLACE[PLACE_BITS-1:0];
    end else if (reset) begin
      strip <= STRIPS[STRIP_BITS-1:0];
    end else if (advance) begin
      if (!last_slot) begin
        k <= k + 1;
        row <= row + 1;
        place <= place + WIDTH[PLACE_BITS-1:0];
      end else begin
        k <= 0;
        column <= last_column ? 0 : column + 1;
        if (last_column) strip <= strip + 1;
        strip_row <= next_strip_row;
        row <= next_strip_row;
        // Also where a strip begins: its first place is that behind the first row of the strip before.
        column_place <= column_place + 1;
        place <= column_place + 1;
      end
    end
  end
endmodule
