// The arbiter of one bank (contract section 2, "Arbiter" and "Banks"). Its ports are in the order of the
// priority list: port 0 comes first. The straps are constants of a board.
module bank_arbiter #(
    parameter PORTS = 6
) (
    input clk, input reset,
    input [1:0] policy,  // 0: fixed priority, 1: round robin, 2: age
    input [4:0] turnaround,  // cycles
    input [PORTS-1:0] request,
    input [PORTS-1:0] write,  // direction of each port
    output reg [PORTS-1:0] grant
);
  reg [PORTS*PORTS-1:0] ahead;  // [port]: those that win against it
  reg [PORTS*PORTS-1:0] was_ahead;
  reg [PORTS-1:0] lower;  // ports that come first in the list
  reg [PORTS-1:0] behind;  // round robin: behind the port granted last
  reg [PORTS-1:0] waits;  // age: refused in the cycle before
  reg [4:0] read_wait;  // cycles until a read can be granted
  reg [4:0] write_wait;
  integer i;
  integer n;

  always @* begin
    for (i = 0; i < PORTS; i = i + 1) begin
      lower = (1 << i) - 1;
      ahead[PORTS*i+:PORTS] = lower;
      if (policy == 1) ahead[PORTS*i+:PORTS] = behind[i] ? behind & lower : behind | lower;
      if (policy == 2) ahead[PORTS*i+:PORTS] = waits[i] ? waits & was_ahead[PORTS*i+:PORTS] : waits | lower;
      // The winner waits while the bank turns round for its direction.
      grant[i] = request[i] && (request & ahead[PORTS*i+:PORTS]) == 0 &&
          (write[i] ? write_wait : read_wait) == 0;
    end
  end

  always @(posedge clk) begin
    was_ahead <= ahead;
    waits <= reset ? 0 : request & ~grant;
    if (reset) behind <= 0;
    else if (grant != 0) for (n = 0; n < PORTS; n = n + 1) behind[n] <= (grant & ((1 << n) - 1)) != 0;
    if (reset) read_wait <= 0;
    else if ((grant & write) != 0) read_wait <= turnaround;
    else if (read_wait != 0) read_wait <= read_wait - 1;
    if (reset) write_wait <= 0;
    else if ((grant & ~write) != 0) write_wait <= turnaround;
    else if (write_wait != 0) write_wait <= write_wait - 1;
  end
endmodule
