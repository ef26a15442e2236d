// Writes the counts of covered lines of a process that ends with _exit(), as children of tests do: the
// compiler's own library writes them at exit() only. Linked into all programs of the preset coverage.

extern "C" {
void __gcov_dump();
[[noreturn]] void __real__exit(int status);

[[noreturn]] void __wrap__exit(int status) {
  __gcov_dump();
  __real__exit(status);
}
}
