// The ports in front of the banks: an arbiter for each bank, and the multiplexers. A port asks one bank at a
// time. Its read data are those of that bank, as many cycles after the grant as the bank takes.
module crossbar #(
    parameter PORTS = 6, parameter BANKS = 8
) (
    input clk, input reset,
    input [1:0] policy,  // of bank_arbiter
    input [3*PORTS-1:0] priority_list,  // the port at each place, the first place in the lowest bits
    input [5*BANKS-1:0] turnaround,
    input [PORTS-1:0] request, input [PORTS-1:0] write, input [6*PORTS-1:0] bank,
    input [26*PORTS-1:0] address, input [32*PORTS-1:0] write_data,
    output reg [PORTS-1:0] grant,
    output reg [32*PORTS-1:0] read_data,
    output [BANKS-1:0] bank_enable, output [BANKS-1:0] bank_write,
    output reg [26*BANKS-1:0] bank_address, output reg [32*BANKS-1:0] bank_write_data,
    input [32*BANKS-1:0] bank_read_data
);
  // In the order of the priority list.
  reg [PORTS*BANKS-1:0] asks;  // [bank][place]
  wire [PORTS*BANKS-1:0] grants;
  reg [PORTS-1:0] writes;  // [place]
  reg [PORTS-1:0] granted;
  reg [26*PORTS-1:0] addresses;
  reg [32*PORTS-1:0] data;
  integer b;
  integer i;

  always @* begin
    for (i = 0; i < PORTS; i = i + 1) begin
      writes[i] = write[priority_list[3*i+:3]];
      addresses[26*i+:26] = address[26*priority_list[3*i+:3]+:26];
      data[32*i+:32] = write_data[32*priority_list[3*i+:3]+:32];
      for (b = 0; b < BANKS; b = b + 1)
        asks[PORTS*b+i] = request[priority_list[3*i+:3]] && bank[6*priority_list[3*i+:3]+:6] == b[5:0];
    end
  end

  genvar number;
  generate
    for (number = 0; number < BANKS; number = number + 1) begin : banks
      bank_arbiter #(.PORTS(PORTS)) arbiter (
          .clk(clk), .reset(reset), .policy(policy), .turnaround(turnaround[5*number+:5]),
          .request(asks[PORTS*number+:PORTS]), .write(writes), .grant(grants[PORTS*number+:PORTS]));
      assign bank_enable[number] = |grants[PORTS*number+:PORTS];
      assign bank_write[number]  = |(grants[PORTS*number+:PORTS] & writes);
    end
  endgenerate

  always @* begin
    granted = 0;
    bank_address = 0;
    bank_write_data = 0;
    for (b = 0; b < BANKS; b = b + 1) begin
      granted = granted | grants[PORTS*b+:PORTS];
      for (i = 0; i < PORTS; i = i + 1) begin
        if (grants[PORTS*b+i]) begin
          bank_address[26*b+:26] = addresses[26*i+:26];
          bank_write_data[32*b+:32] = data[32*i+:32];
        end
      end
    end
    grant = 0;
    for (i = 0; i < PORTS; i = i + 1) grant[priority_list[3*i+:3]] = granted[i];
  end

  always @* begin
    read_data = 0;
    for (i = 0; i < PORTS; i = i + 1)
      for (b = 0; b < BANKS; b = b + 1)
        if (bank[6*i+:6] == b[5:0]) read_data[32*i+:32] = bank_read_data[32*b+:32];
  end
endmodule
