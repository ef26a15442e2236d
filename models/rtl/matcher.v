// From the slots that the matcher consumes to words of results. The words leave STAGES cycles after the last
// of their slots. The pipeline registers fill the path from its beginning; those that the path has no place
// for delay the words.
module matcher #(
    parameter WIDTH = 640, parameter HEIGHT = 480, parameter WINDOW = 7, parameter DISPARITIES = 80,
    parameter HALF = 3,  // of the filter; 0: none
    parameter SHIFT = 6, parameter [16*(2*HALF+1)*(2*HALF+1)-1:0] WEIGHTS = 0, parameter HAS_CHECK = 1,
    parameter TOLERANCE = 0, parameter FIRST_ROW = 0, parameter LEAD_STRIPS = 0, parameter STAGES = 0
) (
    input clk, input reset, input start,
    input enable,  // a slot is consumed
    input first, input last, input completes,
    input [8:0] left,  // valid bit, value
    input [7:0] right, output word_leaves, output [31:0] word
);
  localparam COLUMN_BITS = $clog2(WINDOW * 255 + 1);
  localparam SUM_BITS = $clog2(WINDOW * WINDOW * 255 + 1);
  localparam LEVELS = $clog2(DISPARITIES);

  // The places for pipeline registers, in the order of the path.
  localparam AT_FILTER = 1;  // behind the input
  localparam AT_ARRAY = AT_FILTER + (HALF == 0 ? 0 : 3);
  localparam AT_TREE = AT_ARRAY + 3;
  localparam AT_CHECK = AT_TREE + LEVELS;
  localparam AT_PACKER = AT_CHECK + 1;
  localparam INPUT_STAGES = STAGES >= AT_FILTER ? 1 : 0;
  localparam DIFFERENCE_STAGES = STAGES >= AT_ARRAY + 1 ? 1 : 0;
  localparam COLUMN_STAGES = STAGES >= AT_ARRAY + 2 ? 1 : 0;
  localparam WINDOW_STAGES = STAGES >= AT_TREE ? 1 : 0;
  localparam ARRAY_STAGES = DIFFERENCE_STAGES + COLUMN_STAGES + WINDOW_STAGES;
  localparam TREE_STAGES = STAGES >= AT_CHECK ? LEVELS : STAGES >= AT_TREE ? STAGES - AT_TREE : 0;
  localparam CHECK_STAGES = STAGES >= AT_PACKER ? 1 : 0;
  localparam WORD_STAGES = STAGES >= AT_PACKER ? STAGES - AT_PACKER : 0;

  // Slots before the filter.
  wire in_enable, in_first, in_last, in_completes;
  wire [8:0] in_left;
  wire [7:0] in_right;
  pipe #(.BITS(21), .STAGES(INPUT_STAGES)) input_pipe (
      .clk(clk), .in({enable, first, last, completes, left, right}),
      .out({in_enable, in_first, in_last, in_completes, in_left, in_right}));

  // Slots behind the filter.
  wire slot_enable, slot_first, slot_last, slot_completes;
  wire [8:0] left_filtered;
  wire [7:0] right_filtered;
  generate
    if (HALF == 0) begin : without_filter
      assign {slot_enable, slot_first, slot_last, slot_completes} =
          {in_enable, in_first, in_last, in_completes};
      assign left_filtered = in_left;
      assign right_filtered = in_right;
    end else begin : with_filter
      localparam BEHIND_WINDOW = STAGES >= AT_FILTER + 1 ? 1 : 0;
      localparam BEHIND_ROWS = STAGES >= AT_FILTER + 2 ? 1 : 0;
      localparam BEHIND_SUM = STAGES >= AT_ARRAY ? 1 : 0;
      wire [$clog2(WIDTH)-1:0] column, next_column, centre, next_centre;
      wire is_below, centre_is_top;
      wire [HALF-1:0] has_before, has_behind;
      wire unused;  // valid bit of the right side

      slot_position #(
          .WIDTH(WIDTH), .HEIGHT(HEIGHT), .SLOTS(WINDOW), .FIRST_ROW(FIRST_ROW), .HALF(HALF)
      ) position (
          .clk(clk), .start(start), .enable(in_enable), .last(in_last), .column(column),
          .next_column(next_column), .centre(centre), .next_centre(next_centre), .is_below(is_below),
          .centre_is_top(centre_is_top), .has_before(has_before), .has_behind(has_behind));
      log_filter #(
          .WIDTH(WIDTH), .SLOTS(WINDOW), .HALF(HALF), .SHIFT(SHIFT), .WEIGHTS(WEIGHTS),
          .WINDOW_STAGES(BEHIND_WINDOW), .ROW_STAGES(BEHIND_ROWS), .SUM_STAGES(BEHIND_SUM)
      ) left_filter (
          .clk(clk), .enable(in_enable), .first(in_first), .last(in_last), .pixel(in_left), .column(column),
          .next_column(next_column), .centre(centre), .next_centre(next_centre), .is_below(is_below),
          .centre_is_top(centre_is_top), .has_before(has_before), .has_behind(has_behind),
          .filtered(left_filtered));
      log_filter #(
          .WIDTH(WIDTH), .SLOTS(WINDOW), .HALF(HALF), .SHIFT(SHIFT), .WEIGHTS(WEIGHTS),
          .WINDOW_STAGES(BEHIND_WINDOW), .ROW_STAGES(BEHIND_ROWS), .SUM_STAGES(BEHIND_SUM)
      ) right_filter (
          .clk(clk), .enable(in_enable), .first(in_first), .last(in_last), .pixel({1'b0, in_right}),
          .column(column), .next_column(next_column), .centre(centre), .next_centre(next_centre),
          .is_below(is_below), .centre_is_top(centre_is_top), .has_before(has_before),
          .has_behind(has_behind), .filtered({unused, right_filtered}));
      pipe #(.BITS(4), .STAGES(BEHIND_WINDOW + BEHIND_ROWS + BEHIND_SUM)) filter_flags (
          .clk(clk), .in({in_enable, in_first, in_last, in_completes}),
          .out({slot_enable, slot_first, slot_last, slot_completes}));
    end
  endgenerate

  // Windows.
  wire is_first, has_old, is_inside, ends_row, middle_valid;
  wire [SUM_BITS*DISPARITIES-1:0] sums;
  window_control #(
      .WIDTH(WIDTH), .HEIGHT(HEIGHT), .WINDOW(WINDOW), .HALF(HALF), .LEAD_STRIPS(LEAD_STRIPS)
  ) windows (
      .clk(clk), .start(start), .enable(slot_enable), .first(slot_first), .last(slot_last),
      .left_valid(left_filtered[8]), .is_first(is_first), .has_old(has_old), .is_inside(is_inside),
      .ends_row(ends_row), .middle_valid(middle_valid));
  cost_array #(
      .WINDOW(WINDOW), .DISPARITIES(DISPARITIES), .COLUMN_BITS(COLUMN_BITS), .SUM_BITS(SUM_BITS),
      .DIFFERENCE_STAGES(DIFFERENCE_STAGES), .COLUMN_STAGES(COLUMN_STAGES), .WINDOW_STAGES(WINDOW_STAGES)
  ) array (
      .clk(clk), .enable(slot_enable), .left(left_filtered[7:0]), .right(right_filtered),
      .first(slot_first), .last(slot_last), .is_first(is_first), .has_old(has_old), .sums(sums));
  wire window_enable, window_completes, window_inside, window_ends_row, window_valid;
  pipe #(.BITS(5), .STAGES(ARRAY_STAGES)) array_flags (
      .clk(clk), .in({slot_enable && slot_last, slot_completes, is_inside, ends_row, middle_valid}),
      .out({window_enable, window_completes, window_inside, window_ends_row, window_valid}));

  // Matches.
  wire [DISPARITIES-1:0] counts;
  wire [7:0] chain_disparity, left_based, right_based;
  wire match_enable, match_completes, match_valid;
  candidates #(.DISPARITIES(DISPARITIES)) candidate (
      .clk(clk), .start(start), .enable(window_enable), .is_inside(window_inside),
      .ends_row(window_ends_row), .counts(counts));
  select_min_chain #(.DISPARITIES(DISPARITIES), .SUM_BITS(SUM_BITS)) unit_a (
      .clk(clk), .clear(reset || start), .enable(window_enable), .sums(sums), .counts(counts),
      .disparity(chain_disparity));
  select_min_tree #(.DISPARITIES(DISPARITIES), .SUM_BITS(SUM_BITS), .STAGES(TREE_STAGES)) unit_b (
      .clk(clk), .sums(sums), .counts(counts), .disparity(left_based));
  pipe #(.BITS(11), .STAGES(TREE_STAGES)) tree_flags (
      .clk(clk), .in({window_enable, window_completes, window_valid, chain_disparity}),
      .out({match_enable, match_completes, match_valid, right_based}));

  // Results.
  wire [7:0] checked, disparity;
  wire check_enable, check_completes;
  wire [31:0] packed_word;
  lr_check #(.DISPARITIES(DISPARITIES), .HAS_CHECK(HAS_CHECK), .TOLERANCE(TOLERANCE)) check (
      .clk(clk), .enable(match_enable), .left_based(left_based), .left_valid(match_valid),
      .right_based(right_based), .disparity(checked));
  pipe #(.BITS(10), .STAGES(CHECK_STAGES)) check_pipe (
      .clk(clk), .in({match_enable, match_completes, checked}),
      .out({check_enable, check_completes, disparity}));
  result_packer packer (.clk(clk), .enable(check_enable), .disparity(disparity), .word(packed_word));
  pipe #(.BITS(33), .STAGES(WORD_STAGES)) word_pipe (
      .clk(clk), .in({check_completes, packed_word}), .out({word_leaves, word}));
endmodule
