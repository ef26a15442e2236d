`include "port_states.vh"

// The core of paper figures 5 and 6 with its ports on the banks (contract sections 1 and 2): one lane a side,
// fetch by columns, sum of absolute differences. README.md says what it has not.
//
// A frame begins in the cycle after `start`, which takes the bases too. `start` may come from the cycle on in
// which `ends` is 1: in it the last word of the frame before is written. A base is a bank (bits 31..26) and
// the first word there. Ports, in this order: left_lut, right_lut, left_pixel, right_pixel, result, host.
module stereo_core #(
    parameter WIDTH = 640, parameter HEIGHT = 480, parameter WINDOW = 7, parameter DISPARITIES = 80,
    parameter HALF = 3,  // half width of the filter; 0: none
    parameter SHIFT = 6,
    parameter [16*(2*HALF+1)*(2*HALF+1)-1:0] WEIGHTS = 0,  // row-major, the first one in the lowest bits
    parameter HAS_CHECK = 1, parameter TOLERANCE = 0, parameter LEFT_TABLE = 1, parameter RIGHT_TABLE = 1,
    parameter LANE_FIFO_SLOTS = 16, parameter RESULT_FIFO_WORDS = 8,
    parameter RESULT_DELAY_CYCLES = 0,  // pipeline registers from the slot to the queue of results
    parameter BANKS = 8
) (
    input clk, input reset,
    // Straps: constants of a board.
    input [1:0] policy,  // of bank_arbiter
    input [17:0] priority_list,
    input [5*BANKS-1:0] turnaround,  // cycles, of each bank
    input [BANKS-1:0] latency_2,  // read latency of each bank: 2 cycles, else 1
    // Frames.
    input start, input [32*5-1:0] bases, output reg busy, output ends,
    output reg [63:0] cycles,  // of the frame, up to now; up to its last write
    // The local bus: a word at a time. What it reads comes as many cycles after the grant as the bank takes,
    // and only if host_address is still in the same bank.
    input host_request, input host_write,
    input [31:0] host_address,  // as a base
    input [31:0] host_write_data, output host_granted, output [31:0] host_read_data,
    // Banks.
    output [BANKS-1:0] bank_enable, output [BANKS-1:0] bank_write,
    output [26*BANKS-1:0] bank_address, output [32*BANKS-1:0] bank_write_data,
    input [32*BANKS-1:0] bank_read_data,
    // To observe: what each port of the core does (port_states.vh), where, and whether it is granted.
    output [14:0] port_state,
    output [32*5-1:0] port_address,  // as a base
    output [4:0] port_granted, output consumes
);
  localparam PORTS = 6;
  localparam RADIUS = (WINDOW - 1) / 2;
  localparam LEAD_STRIPS = HALF > RADIUS ? HALF - RADIUS : 0;
  localparam STRIPS = HEIGHT + LEAD_STRIPS;
  localparam FIRST_ROW = HALF - RADIUS - LEAD_STRIPS;
  localparam DRAIN_COLUMNS = DISPARITIES - 1 + RADIUS + HALF;

  reg [32*5-1:0] base;  // of the frame
  wire [26*PORTS-1:0] address;
  wire [6*PORTS-1:0] bank;
  wire [PORTS-1:0] request, grant;
  wire [32*PORTS-1:0] read_data;
  wire [31:0] result_data;
  wire [63:0] latency_of = {{(64 - BANKS) {1'b0}}, latency_2};
  wire unused = &read_data[32*4+:32];  // the result port writes
  assign bank[30+:6] = host_address[31:26];
  assign address[26*5+:26] = host_address[25:0];
  assign request[5] = host_request;
  assign host_granted = grant[5];
  assign host_read_data = read_data[32*5+:32];
  assign port_granted = grant[4:0];
  genvar port;
  generate
    for (port = 0; port < 5; port = port + 1) begin : ports
      assign bank[6*port+:6] = base[32*port+26+:6];
      assign request[port] = port_state[3*port+:3] == `PORT_REQUEST;
      assign port_address[32*port+:32] = {bank[6*port+:6], address[26*port+:26]};
    end
  endgenerate

  always @(posedge clk) begin
    if (start) base <= bases;
    if (reset) busy <= 0;
    else if (start) busy <= 1;
    else if (ends) busy <= 0;
    if (start) cycles <= 0;
    else if (busy) cycles <= cycles + 1;
  end

  wire consume, draining, first, last, completes, left_ready, right_ready;
  wire [8:0] left_pixel;
  wire [7:0] right_pixel;
  wire unused_valid;  // of the right pixel
  wire takes = consume && !draining;
  assign consumes = consume;

  lane #(
      .WIDTH(WIDTH), .HEIGHT(HEIGHT), .SLOTS(WINDOW), .FIRST_ROW(FIRST_ROW), .STRIPS(STRIPS),
      .HAS_TABLE(LEFT_TABLE), .FIFO_SLOTS(LANE_FIFO_SLOTS)
  ) left_lane (
      .clk(clk), .reset(reset), .start(start), .table_latency_2(latency_of[bank[0+:6]]),
      .image_latency_2(latency_of[bank[12+:6]]), .table_base(base[0+:26]),
      .image_base(base[64+:26]), .table_state(port_state[2:0]),
      .table_address(address[0+:26]), .table_granted(grant[0]), .table_data(read_data[31:0]),
      .pixel_state(port_state[8:6]), .pixel_address(address[26*2+:26]),
      .pixel_granted(grant[2]), .pixel_data(read_data[64+:32]), .ready(left_ready), .pixel(left_pixel),
      .consumes(takes));
  lane #(
      .WIDTH(WIDTH), .HEIGHT(HEIGHT), .SLOTS(WINDOW), .FIRST_ROW(FIRST_ROW), .STRIPS(STRIPS),
      .HAS_TABLE(RIGHT_TABLE), .FIFO_SLOTS(LANE_FIFO_SLOTS)
  ) right_lane (
      .clk(clk), .reset(reset), .start(start), .table_latency_2(latency_of[bank[6+:6]]),
      .image_latency_2(latency_of[bank[18+:6]]), .table_base(base[32+:26]),
      .image_base(base[96+:26]), .table_state(port_state[5:3]),
      .table_address(address[26+:26]), .table_granted(grant[1]),
      .table_data(read_data[32+:32]), .pixel_state(port_state[11:9]),
      .pixel_address(address[26*3+:26]), .pixel_granted(grant[3]),
      .pixel_data(read_data[96+:32]), .ready(right_ready), .pixel({unused_valid, right_pixel}),
      .consumes(takes));

  wire has_room, word_leaves;
  wire [31:0] word;
  match_control #(
      .WIDTH(WIDTH), .SLOTS(WINDOW), .STRIPS(STRIPS), .DRAIN_COLUMNS(DRAIN_COLUMNS),
      .RESULT_DELAY(DRAIN_COLUMNS + LEAD_STRIPS * WIDTH)
  ) control (
      .clk(clk), .reset(reset), .start(start), .ready(left_ready && right_ready), .has_room(has_room),
      .consume(consume), .draining(draining), .first(first), .last(last), .completes(completes));
  matcher #(
      .WIDTH(WIDTH), .HEIGHT(HEIGHT), .WINDOW(WINDOW), .DISPARITIES(DISPARITIES), .HALF(HALF),
      .SHIFT(SHIFT), .WEIGHTS(WEIGHTS), .HAS_CHECK(HAS_CHECK), .TOLERANCE(TOLERANCE), .FIRST_ROW(FIRST_ROW),
      .LEAD_STRIPS(LEAD_STRIPS), .STAGES(RESULT_DELAY_CYCLES)
  ) datapath (
      .clk(clk), .reset(reset), .start(start), .enable(consume), .first(first), .last(last),
      .completes(completes), .left(draining ? 9'd0 : left_pixel), .right(draining ? 8'd0 : right_pixel),
      .word_leaves(word_leaves), .word(word));
  result_port #(
      .WORDS(WIDTH * HEIGHT / 4), .FIFO_WORDS(RESULT_FIFO_WORDS)
  ) results (
      .clk(clk), .reset(reset), .start(start), .base(base[128+:26]), .reserve(completes),
      .has_room(has_room), .enters(word_leaves), .word(word), .state(port_state[14:12]),
      .address(address[26*4+:26]), .data(result_data), .granted(grant[4]), .done(ends));

  crossbar #(.PORTS(PORTS), .BANKS(BANKS)) memory (
      .clk(clk), .reset(reset), .policy(policy), .priority_list(priority_list), .turnaround(turnaround),
      .request(request), .write({host_write, 5'b10000}), .bank(bank), .address(address),
      .write_data({host_write_data, result_data, 128'd0}), .grant(grant), .read_data(read_data),
      .bank_enable(bank_enable), .bank_write(bank_write), .bank_address(bank_address),
      .bank_write_data(bank_write_data), .bank_read_data(bank_read_data));
endmodule
