// What the window modules and the select-min units have to know of a column: its window is the one that ends
// with this column.
module window_control #(
    parameter WIDTH = 640, parameter HEIGHT = 480, parameter integer WINDOW = 7,
    parameter HALF = 3,  // of the filter
    parameter LEAD_STRIPS = 0  // strips before that of row 0
) (
    input clk, input start, input enable,
    input first,  // slot of its column
    input last,
    input left_valid,  // valid bit of the slot's left pixel
    output is_first,  // the column is the first of the frame
    output has_old,  // n columns or more have come before it
    output is_inside,  // the window lies inside the image
    output ends_row,  // the middle of the window is in the last column
    output middle_valid  // valid bit of the left pixel in the middle of the window
);
  localparam integer RADIUS = (WINDOW - 1) / 2;
  localparam BEHIND = RADIUS + HALF;  // columns from the middle of the window to the column
  localparam COLUMN_BITS = $clog2(WIDTH);
  localparam ROW_BITS = $clog2(2 * HEIGHT + 2 * LEAD_STRIPS + 4 * BEHIND + 4) + 1;
  localparam COUNT_BITS = $clog2(WINDOW + 1);
  localparam K_BITS = $clog2(WINDOW);
  localparam integer FIRST_COLUMN = (WIDTH - BEHIND % WIDTH) % WIDTH;
  localparam integer LAST_COLUMN = WIDTH - 1;
  localparam integer FIRST_ROW = -LEAD_STRIPS - (BEHIND + WIDTH - 1) / WIDTH;

  reg [COLUMN_BITS-1:0] column;  // of the middle of the window
  reg [ROW_BITS-1:0] row;
  reg [COUNT_BITS-1:0] columns;  // that have come, up to n
  reg [K_BITS-1:0] k;
  reg [RADIUS-1:0] valid_before;  // of the middle row of the columns before
  reg valid_of_column;
  wire [RADIUS-1:0] next_valid;

  wire signed [31:0] column_number = {{(32 - COLUMN_BITS) {1'b0}}, column};
  wire signed [31:0] row_number = {{(32 - ROW_BITS) {row[ROW_BITS-1]}}, row};
  assign is_first = columns == 0;
  assign has_old = columns == WINDOW[COUNT_BITS-1:0];
  assign is_inside = column_number >= RADIUS && column_number < WIDTH - RADIUS &&
      row_number >= RADIUS && row_number < HEIGHT - RADIUS;
  assign ends_row = column == LAST_COLUMN[COLUMN_BITS-1:0];
  assign {middle_valid, next_valid} = {valid_before, valid_of_column};

  always @(posedge clk) begin
    if (start) begin
      column <= FIRST_COLUMN[COLUMN_BITS-1:0];
      row <= FIRST_ROW[ROW_BITS-1:0];
      columns <= 0;
    end else if (enable && last) begin
      column <= ends_row ? 0 : column + 1;
      if (ends_row) row <= row + 1;
      if (!has_old) columns <= columns + 1;
      valid_before <= next_valid;
    end
    if (enable) begin
      k <= first ? 1 : k + 1;
      if (!first && k == RADIUS[K_BITS-1:0]) valid_of_column <= left_valid;
    end
  end
endmodule
