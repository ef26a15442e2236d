// A queue whose input can leave in the cycle in which it arrives. The user never pushes more than SLOTS
// entries that are not popped.
module queue #(
    parameter BITS = 32, parameter SLOTS = 16
) (
    input clk, input clear, input push, input [BITS-1:0] in, input pop, output has_head,
    output [BITS-1:0] head
);
  localparam COUNT_BITS = $clog2(SLOTS + 1);
  localparam PLACE_BITS = SLOTS == 1 ? 1 : $clog2(SLOTS);
  localparam integer LAST = SLOTS - 1;

  reg [BITS-1:0] memory[0:SLOTS-1];
  reg [PLACE_BITS-1:0] first, free;
  reg [COUNT_BITS-1:0] count;  // of the entries in memory

  assign has_head = count != 0 || push;
  assign head = count != 0 ? memory[first] : in;
  wire stores = push && !(pop && count == 0);
  wire removes = pop && count != 0;

  always @(posedge clk) begin
    if (stores) memory[free] <= in;
    if (clear) begin
      first <= 0;
      free  <= 0;
      count <= 0;
    end else begin
      if (stores) free <= free == LAST[PLACE_BITS-1:0] ? 0 : free + 1;
      if (removes) first <= first == LAST[PLACE_BITS-1:0] ? 0 : first + 1;
      if (stores != removes) count <= stores ? count + 1 : count - 1;
    end
  end
endmodule
