// The arbiter of one bank (contract section 2, "Arbiter" and "Banks"). It works on places of the priority
// list: place i is ahead of place j where ahead[i][j] is 1. The straps are constants of a board.
module bank_arbiter #(
    parameter PORTS = 6
) (
    input clk, input reset,
    input [1:0] policy,  // 0: fixed priority, 1: round robin, 2: age
    input [3*PORTS-1:0] priority_list,  // the port at each place, place 0 in the lowest bits
    input [4:0] turnaround,  // cycles
    input [PORTS-1:0] request,
    input [PORTS-1:0] write,  // direction of each port
    output reg [PORTS-1:0] grant
);
  reg [PORTS-1:0] asks;  // [place]
  reg [PORTS-1:0] wins;
  reg [PORTS*PORTS-1:0] ahead;  // [place i][place j]
  reg [PORTS*PORTS-1:0] was_ahead;
  reg [PORTS-1:0] waits;  // age: was refused in the cycle before
  reg [PORTS-1:0] behind;  // round robin: behind the place granted last
  reg [4:0] read_wait;  // cycles until a read can be granted
  reg [4:0] write_wait;
  wire writes = |(grant & write);
  wire reads = |(grant & ~write);
  integer i;
  integer j;

  always @* begin
    for (i = 0; i < PORTS; i = i + 1) asks[i] = request[priority_list[3*i+:3]];
    for (i = 0; i < PORTS; i = i + 1) begin
      for (j = 0; j < PORTS; j = j + 1) begin
        ahead[PORTS*i+j] = i < j;
        if (policy == 1 && behind[i] != behind[j]) ahead[PORTS*i+j] = behind[i];
        if (policy == 2 && waits[i] != waits[j]) ahead[PORTS*i+j] = waits[i];
        if (policy == 2 && waits[i] && waits[j]) ahead[PORTS*i+j] = was_ahead[PORTS*i+j];
      end
    end
    for (i = 0; i < PORTS; i = i + 1) begin
      wins[i] = asks[i];
      for (j = 0; j < PORTS; j = j + 1) if (i != j && asks[j] && ahead[PORTS*j+i]) wins[i] = 0;
      // The winner waits while the bank turns round for its direction.
      if ((write[priority_list[3*i+:3]] ? write_wait : read_wait) != 0) wins[i] = 0;
    end
    grant = 0;
    for (i = 0; i < PORTS; i = i + 1) grant[priority_list[3*i+:3]] = wins[i];
  end

  always @(posedge clk) begin
    was_ahead <= ahead;
    waits <= reset ? 0 : asks & ~wins;
    if (reset) behind <= 0;
    else if (wins != 0) for (i = 0; i < PORTS; i = i + 1) behind[i] <= (wins & ((1 << i) - 1)) != 0;
    if (reset) read_wait <= 0;
    else if (writes) read_wait <= turnaround;
    else if (read_wait != 0) read_wait <= read_wait - 1;
    if (reset) write_wait <= 0;
    else if (reads) write_wait <= turnaround;
    else if (write_wait != 0) write_wait <= write_wait - 1;
  end
endmodule
