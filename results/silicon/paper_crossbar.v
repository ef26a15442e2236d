// The crossbar as the paper's board ties it: fixed priority, memories without turnaround, a bank for each
// table, two banks in turn for each image and for the results, and the host at all of them.
module paper_crossbar (
    input clk, input reset, input [1:0] policy, input [17:0] priority_list, input [39:0] turnaround,
    input [5:0] request, input [5:0] write, input [35:0] bank, input [155:0] address,
    input [191:0] write_data, output [5:0] grant, output [191:0] read_data, output [7:0] bank_enable,
    output [7:0] bank_write, output [207:0] bank_address, output [255:0] bank_write_data,
    input [255:0] bank_read_data
);
  // Ports: host, results, right and left pixels, right and left table.
  wire [35:0] reached = {3'd0, bank[32:30], 5'd2, bank[24], 5'd1, bank[18], 5'd0, bank[12], 6'd7, 6'd6};
  crossbar #(.PORTS(6), .BANKS(8)) banks (
      .clk(clk), .reset(reset), .policy(2'd0), .priority_list({3'd1, 3'd0, 3'd3, 3'd2, 3'd4, 3'd5}),
      .turnaround(40'd0), .request(request), .write({write[5], 5'b10000}), .bank(reached), .address(address),
      .write_data(write_data), .grant(grant), .read_data(read_data), .bank_enable(bank_enable),
      .bank_write(bank_write), .bank_address(bank_address), .bank_write_data(bank_write_data),
      .bank_read_data(bank_read_data));
endmodule
