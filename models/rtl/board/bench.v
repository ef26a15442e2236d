`include "board.vh"

// Test bench: stereo_fpga with its banks. It runs the frames of one turn of the board's lists of buffers, each
// with the same pair, and compares every word that the core writes, and the cycles of each frame, with those of
// `stereotlm run`.
module bench (
    input clk,
    output reg done,
    output reg failed
);
  localparam RESET_CYCLES = 100;
  localparam integer WORDS = `BOARD_WIDTH * `BOARD_HEIGHT / 4;
  localparam integer LAST_WORD = WORDS - 1;
  localparam WORD_BITS = $clog2(WORDS + 1);
  localparam [32*`BOARD_BANKS-1:0] BANK_WORDS = `BOARD_BANK_WORDS;
  localparam [`BOARD_BANKS-1:0] LATENCY_2 = `BOARD_LATENCY_2;
  localparam [160*`BOARD_FRAMES-1:0] BASES = `BOARD_BASES;

  // Of run.
  reg [31:0] disparities[0:WORDS-1];  // the same in each frame
  reg [63:0] cycles[0:`BOARD_FRAMES-1];  // of each frame

  integer file;  // disparity.pgm, those of the core in the last frame
  integer frame = -1;  // that runs, or has run last
  integer pause = RESET_CYCLES + 1;  // 1: a frame starts in this cycle; 0: when the frame ends
  reg [63:0] cycle;  // of the frame
  reg [WORD_BITS-1:0] written;  // words
  integer wrong;  // of these
  reg [31:0] base;  // of the disparities

  wire is_last = frame == `BOARD_FRAMES - 1;
  wire ends;
  wire start = pause == 1 || (ends && !is_last && `BOARD_PIPELINE_LATENCY_CYCLES == 0);
  wire [31:0] next = frame + 1;
  wire [159:0] bases = BASES[160*(is_last ? 0 : next)+:160];
  wire [`BOARD_BANKS-1:0] enable, write;
  wire [26*`BOARD_BANKS-1:0] address;
  wire [32*`BOARD_BANKS-1:0] write_data, read_data;
  wire unused_busy, unused_granted;
  wire [63:0] unused_cycles;
  wire [31:0] unused_data;

  stereo_fpga fpga (
      .clk(clk), .reset(frame < 0 && pause > 1), .start(start), .bases(bases), .busy(unused_busy),
      .ends(ends), .cycles(unused_cycles), .host_request(1'b0), .host_write(1'b0), .host_address(32'd0),
      .host_write_data(32'd0), .host_granted(unused_granted), .host_read_data(unused_data),
      .bank_enable(enable), .bank_write(write), .bank_address(address), .bank_write_data(write_data),
      .bank_read_data(read_data));

  genvar n;
  generate
    for (n = 0; n < `BOARD_BANKS; n = n + 1) begin : banks
      localparam [7:0] TENS = "0" + n / 10;
      localparam [7:0] ONES = "0" + n % 10;
      ssram_bank #(.WORDS(BANK_WORDS[32*n+:32]), .LATENCY_2(LATENCY_2[n]), .NUMBER({TENS, ONES})) bank (
          .clk(clk), .enable(enable[n]), .write(write[n]), .address(address[26*n+:26]),
          .write_data(write_data[32*n+:32]), .read_data(read_data[32*n+:32]));
    end
  endgenerate

  // Words are written in the order of the buffer.
  wire [`BOARD_BANKS-1:0] one = 1;
  wire writes = |(enable & write);
  wire [31:0] word = write_data[32*base[31:26]+:32];
  wire is_right = (enable & write) == one << base[31:26] && word == disparities[written] &&
      address[26*base[31:26]+:26] == base[25:0] + {{(26 - WORD_BITS) {1'b0}}, written};
  wire [31:0] all_wrong = wrong + {31'd0, writes && !is_right};
  wire [63:0] frame_cycles = cycle + 1 + `BOARD_PIPELINE_LATENCY_CYCLES;
  wire [63:0] run_cycles = cycles[frame];

  initial begin
    $readmemh("disparity.hex", disparities);
    $readmemh("cycles.hex", cycles);
    done = 0;
    failed = 0;
  end

  always @(posedge clk) begin
    if (pause != 0) pause <= pause - 1;
    cycle <= cycle + 1;
    if (writes) begin
      $fwrite(file, "%0d %0d %0d %0d\n", word[7:0], word[15:8], word[23:16], word[31:24]);
      written <= written + 1;
      wrong <= all_wrong;
      if (!is_right && wrong == 0)
        $display("frame %0d: word %0d of the disparities is %h, of run %h", frame, written, word,
                 disparities[written]);
    end
    if (ends) begin
      $display("frame %0d: %0d cycles, of run %0d; %0d of %0d words of disparities differ", frame,
               frame_cycles, run_cycles, all_wrong, WORDS);
      if (frame_cycles != run_cycles || all_wrong != 0 || written != LAST_WORD[WORD_BITS-1:0]) failed <= 1;
      if (is_last) done <= 1;
      else pause <= `BOARD_PIPELINE_LATENCY_CYCLES;
    end
    if (start) begin
      frame <= frame + 1;
      cycle <= 0;
      written <= 0;
      wrong <= 0;
      base <= bases[159:128];
      file = $fopen("disparity.pgm", "w");
      $fwrite(file, "P2 %0d %0d 255\n", `BOARD_WIDTH, `BOARD_HEIGHT);
    end
    if (frame >= 0 && cycle == run_cycles + 1000) begin
      $display("frame %0d: has not ended after %0d cycles; %0d of %0d words are written", frame, cycle,
               written, WORDS);
      failed <= 1;
      done <= 1;
    end
  end
endmodule
