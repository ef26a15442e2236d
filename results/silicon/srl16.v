// Maps the shift registers that Yosys finds to SRL16E cells in a row: Virtex-II has none that is longer.
(* techmap_celltype = "$__XILINX_SHREG_" *)
module cut_to_srl16 (input C, input D, input [31:0] L, input E, output Q, output SO);
  parameter DEPTH = 0;
  parameter [DEPTH-1:0] INIT = 0;
  parameter CLKPOL = 1;
  parameter ENPOL = 2;  // 0, 1: level of E that enables; 2: always enabled
  localparam HERE = DEPTH > 16 ? 16 : DEPTH;
  localparam [3:0] ADDRESS = HERE - 1;
  wire _TECHMAP_FAIL_ = CLKPOL != 1;
  wire enable = ENPOL == 2 ? 1'b1 : ENPOL == 1 ? E : ~E;
  wire out;
  generate
    if (HERE == 1) FDRE register (.C(C), .CE(enable), .R(1'b0), .D(D), .Q(out));
    else SRL16E shifter (.A0(ADDRESS[0]), .A1(ADDRESS[1]), .A2(ADDRESS[2]), .A3(ADDRESS[3]), .CLK(C),
                         .CE(enable), .D(D), .Q(out));
    if (DEPTH > HERE)
      \$__XILINX_SHREG_ #(.DEPTH(DEPTH - HERE), .CLKPOL(CLKPOL), .ENPOL(ENPOL))
          rest (.C(C), .D(out), .L(L), .E(E), .Q(Q));
    else assign Q = out;
  endgenerate
endmodule
