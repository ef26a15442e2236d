`include "board.vh"

// The FPGA of a board: the core with the parameters and the straps of the board. The ports are those of
// stereo_core.
module stereo_fpga (
    input clk, input reset, input start, input [32*5-1:0] bases, output busy, output ends,
    output [63:0] cycles, input host_request, input host_write, input [31:0] host_address,
    input [31:0] host_write_data, output host_granted, output [31:0] host_read_data,
    output [`BOARD_BANKS-1:0] bank_enable, output [`BOARD_BANKS-1:0] bank_write,
    output [26*`BOARD_BANKS-1:0] bank_address, output [32*`BOARD_BANKS-1:0] bank_write_data,
    input [32*`BOARD_BANKS-1:0] bank_read_data
);
  // What the core lets observe.
  wire [14:0] unused_state;
  wire [32*5-1:0] unused_address;
  wire [4:0] unused_granted;
  wire unused_consumes;

  stereo_core #(
      .WIDTH(`BOARD_WIDTH), .HEIGHT(`BOARD_HEIGHT), .WINDOW(`BOARD_WINDOW),
      .DISPARITIES(`BOARD_DISPARITIES), .HALF(`BOARD_HALF), .SHIFT(`BOARD_SHIFT), .WEIGHTS(`BOARD_WEIGHTS),
      .HAS_CHECK(`BOARD_HAS_CHECK), .TOLERANCE(`BOARD_TOLERANCE), .LEFT_TABLE(`BOARD_LEFT_TABLE),
      .RIGHT_TABLE(`BOARD_RIGHT_TABLE), .LANE_FIFO_SLOTS(`BOARD_LANE_FIFO_SLOTS),
      .RESULT_FIFO_WORDS(`BOARD_RESULT_FIFO_WORDS), .RESULT_DELAY_CYCLES(`BOARD_RESULT_DELAY_CYCLES),
      .BANKS(`BOARD_BANKS)
  ) core (
      .clk(clk), .reset(reset), .policy(`BOARD_POLICY), .priority_list(`BOARD_PRIORITY_LIST),
      .turnaround(`BOARD_TURNAROUND), .latency_2(`BOARD_LATENCY_2), .start(start), .bases(bases),
      .busy(busy), .ends(ends), .cycles(cycles), .host_request(host_request), .host_write(host_write),
      .host_address(host_address), .host_write_data(host_write_data), .host_granted(host_granted),
      .host_read_data(host_read_data), .bank_enable(bank_enable), .bank_write(bank_write),
      .bank_address(bank_address), .bank_write_data(bank_write_data), .bank_read_data(bank_read_data),
      .port_state(unused_state), .port_address(unused_address), .port_granted(unused_granted),
      .consumes(unused_consumes));
endmodule
