// What a port does in a cycle (contract section 2, "Port states"). A request is granted or stalls.
`ifndef PORT_STATES
`define PORT_STATES
`define PORT_REQUEST 3'd0
`define PORT_PASS 3'd1
`define PORT_IDLE 3'd2
`define PORT_BLOCKED 3'd3
`define PORT_STARVED 3'd4
`endif
