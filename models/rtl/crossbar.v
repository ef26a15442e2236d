// The ports in front of the banks: an arbiter for each bank, and the multiplexers. A port asks one bank at a
// time. Its read data are those of that bank, as many cycles after the grant as the bank takes.
module crossbar #(
    parameter PORTS = 6, parameter BANKS = 8
) (
    input clk, input reset, input [1:0] policy, input [3*PORTS-1:0] priority_list,
    input [5*BANKS-1:0] turnaround, input [PORTS-1:0] request, input [PORTS-1:0] write,
    input [6*PORTS-1:0] bank, input [26*PORTS-1:0] address, input [32*PORTS-1:0] write_data,
    output reg [PORTS-1:0] grant, output reg [32*PORTS-1:0] read_data, output [BANKS-1:0] bank_enable,
    output [BANKS-1:0] bank_write, output reg [26*BANKS-1:0] bank_address,
    output reg [32*BANKS-1:0] bank_write_data, input [32*BANKS-1:0] bank_read_data
);
  reg [PORTS*BANKS-1:0] asks;  // [bank][port]
  wire [PORTS*BANKS-1:0] grants;
  integer b;
  integer p;

  always @* begin
    for (b = 0; b < BANKS; b = b + 1)
      for (p = 0; p < PORTS; p = p + 1) asks[PORTS*b+p] = request[p] && bank[6*p+:6] == b[5:0];
  end

  genvar number;
  generate
    for (number = 0; number < BANKS; number = number + 1) begin : banks
      bank_arbiter #(.PORTS(PORTS)) arbiter (
          .clk(clk), .reset(reset), .policy(policy), .priority_list(priority_list),
          .turnaround(turnaround[5*number+:5]), .request(asks[PORTS*number+:PORTS]), .write(write),
          .grant(grants[PORTS*number+:PORTS]));
      assign bank_enable[number] = |grants[PORTS*number+:PORTS];
      assign bank_write[number]  = |(grants[PORTS*number+:PORTS] & write);
    end
  endgenerate

  always @* begin
    grant = 0;
    bank_address = 0;
    bank_write_data = 0;
    for (b = 0; b < BANKS; b = b + 1) begin
      grant = grant | grants[PORTS*b+:PORTS];
      for (p = 0; p < PORTS; p = p + 1) begin
        if (grants[PORTS*b+p]) begin
          bank_address[26*b+:26] = address[26*p+:26];
          bank_write_data[32*b+:32] = write_data[32*p+:32];
        end
      end
    end
  end

  always @* begin
    read_data = 0;
    for (b = 0; b < BANKS; b = b + 1)
      for (p = 0; p < PORTS; p = p + 1)
        if (bank[6*p+:6] == b[5:0]) read_data[32*p+:32] = bank_read_data[32*b+:32];
  end
endmodule
