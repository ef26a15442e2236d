// Decides when the matcher consumes a slot of both lanes (contract section 2, "Matcher"), first those of all
// strips, then the drain. A word of results has its place in the queue from the consume-cycle on that
// completes it.
module match_control #(
    parameter WIDTH = 640, parameter SLOTS = 7, parameter STRIPS = 480, parameter DRAIN_COLUMNS = 85,
    parameter RESULT_DELAY = 85  // columns from the first one of the frame to the one with the first result
) (
    input clk, input reset, input start,
    input ready,  // both lanes have a slot
    input has_room,  // the queue of results has a free place
    output consume,
    output draining,  // without slots
    output first,  // the slot is the first of its column
    output last,
    output completes  // it completes a word of results
);
  localparam integer LAST_SLOT = SLOTS - 1;
  localparam K_BITS = $clog2(SLOTS + 1);
  localparam integer COLUMNS = STRIPS * WIDTH;
  localparam COLUMN_BITS = $clog2(COLUMNS + 1);
  localparam DRAIN_BITS = $clog2(DRAIN_COLUMNS + 1);
  localparam DELAY_BITS = $clog2(RESULT_DELAY + 1);

  reg [K_BITS-1:0] k;
  reg [COLUMN_BITS-1:0] columns_left;
  reg [DRAIN_BITS-1:0] drain_left;  // columns of the drain
  reg [DELAY_BITS-1:0] delay_left;  // columns without result
  reg [1:0] group;  // results of the word that are there

  assign draining = columns_left == 0;
  assign first = k == 0;
  assign last = k == LAST_SLOT[K_BITS-1:0];
  assign consume = has_room && (draining ? drain_left != 0 : ready);
  assign completes = consume && last && delay_left == 0 && group == 3;

  always @(posedge clk) begin
    if (reset || start) begin
      k <= 0;
      columns_left <= start ? COLUMNS[COLUMN_BITS-1:0] : 0;
      drain_left <= start ? DRAIN_COLUMNS[DRAIN_BITS-1:0] : 0;
      delay_left <= RESULT_DELAY[DELAY_BITS-1:0];
      group <= 0;
    end else if (consume) begin
      k <= last ? 0 : k + 1;
      if (last) begin
        if (!draining) columns_left <= columns_left - 1;
        else drain_left <= drain_left - 1;
        if (delay_left != 0) delay_left <= delay_left - 1;
        else group <= group + 1;
      end
    end
  end
endmodule
