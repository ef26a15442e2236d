// Runs the test bench (bench.v) under Verilator. The exit status is 0 if the core is as run.
#include <Vbench.h>
#include <verilated.h>

#include <cstdio>

int main(int argc, char** argv) {
  Verilated::commandArgs(argc, argv);
  Vbench bench;
  bench.clk = 0;
  bench.eval();
  while (!bench.done) {
    bench.clk = !bench.clk;
    bench.eval();
  }
  bench.final();
  std::puts(bench.failed ? "the core is NOT as run" : "the core is as run in each disparity and cycle");
  return bench.failed;
}
