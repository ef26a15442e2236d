`include "port_states.vh"

// The lane of one side: from the sequence of slots to the matcher (contract section 2, "Lane"). At most
// FIFO_SLOTS slots are in it. On a side without table the pixel port takes the slots itself.
module lane #(
    parameter WIDTH = 640, parameter HEIGHT = 480, parameter SLOTS = 7, parameter FIRST_ROW = -3,
    parameter STRIPS = 480, parameter HAS_TABLE = 1, parameter FIFO_SLOTS = 16
) (
    input clk, input reset, input start,
    input table_latency_2,  // of the bank with the table: 2 cycles, else 1
    input image_latency_2,
    input [25:0] table_base,  // first word of the table
    input [25:0] image_base, output [2:0] table_state, output [25:0] table_address,
    input table_granted, input [31:0] table_data, output [2:0] pixel_state,
    output [25:0] pixel_address, input pixel_granted, input [31:0] pixel_data,
    output ready,  // the matcher can consume a slot
    output [8:0] pixel,  // its valid bit and value
    input consumes
);
  localparam PLACE_BITS = WIDTH * HEIGHT <= 8 ? 3 : $clog2(WIDTH * HEIGHT);
  localparam COUNT_BITS = $clog2(FIFO_SLOTS + 1);

  wire clear = reset || start;
  wire takes, handles, empty, done;
  wire [PLACE_BITS-1:0] place;
  reg [COUNT_BITS-1:0] slots;  // in the lane
  wire is_full = slots == FIFO_SLOTS[COUNT_BITS-1:0];
  wire [2:0] take_state = done ? `PORT_IDLE : is_full ? `PORT_BLOCKED : empty ? `PORT_PASS : `PORT_REQUEST;

  sequencer #(
      .WIDTH(WIDTH), .HEIGHT(HEIGHT), .SLOTS(SLOTS), .FIRST_ROW(FIRST_ROW), .STRIPS(STRIPS),
      .PLACE_BITS(PLACE_BITS)
  ) slot (
      .clk(clk), .reset(reset), .start(start), .advance(takes), .place(place), .empty(empty), .done(done));

  always @(posedge clk) begin
    if (clear) slots <= 0;
    else if (takes != consumes) slots <= takes ? slots + 1 : slots - 1;
  end

  wire [1:0] byte_number;
  generate
    if (HAS_TABLE != 0) begin : with_table
      localparam integer ROW_WORDS = WIDTH / 4;
      wire has_entry;
      wire [22:0] entry;
      reg [COUNT_BITS-1:0] waiting;  // slots that are taken and not handled
      reg begun;  // a slot is handled
      wire [21:0] pixel_word = entry[21:11] * ROW_WORDS[10:0] + {13'd0, entry[10:2]};

      assign table_state = take_state;
      assign table_address = table_base + {{(26 - PLACE_BITS) {1'b0}}, place};
      assign byte_number = entry[1:0];
      assign pixel_address = image_base + {4'd0, pixel_word};
      assign pixel_state = has_entry ? (entry[22] ? `PORT_REQUEST : `PORT_PASS) :
          !begun || (waiting == 0 && done) ? `PORT_IDLE : `PORT_STARVED;

      always @(posedge clk) begin
        if (clear) begin
          waiting <= 0;
          begun <= 0;
        end else begin
          if (takes != handles) waiting <= takes ? waiting + 1 : waiting - 1;
          begun <= begun || handles;
        end
      end

      table_port #(.FIFO_SLOTS(FIFO_SLOTS)) reader (
          .clk(clk), .clear(clear), .latency_2(table_latency_2), .take_state(take_state),
          .granted(table_granted), .data(table_data), .takes(takes), .has_entry(has_entry), .entry(entry),
          .handles(handles));
    end else begin : without_table
      wire unused = &{table_latency_2, table_base, table_granted, table_data};
      assign takes = handles;
      assign table_state = `PORT_IDLE;
      assign table_address = 0;
      assign byte_number = place[1:0];
      assign pixel_address = image_base + {{(26 - PLACE_BITS + 2) {1'b0}}, place[PLACE_BITS-1:2]};
      assign pixel_state = take_state;
    end
  endgenerate

  pixel_port #(.FIFO_SLOTS(FIFO_SLOTS)) reader (
      .clk(clk), .clear(clear), .latency_2(image_latency_2), .state(pixel_state), .byte_number(byte_number),
      .granted(pixel_granted), .data(pixel_data), .handles(handles), .ready(ready), .pixel(pixel),
      .consumes(consumes));
endmodule
