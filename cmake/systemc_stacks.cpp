// Informs the address sanitizer about the stacks of SystemC processes, as far as SystemC 2.3.4 does not.
// Linked into the programs that simulate if they are built with that sanitizer.
//
// The sanitizer knows the bounds of one stack, the current one. It uses them where an exception is thrown and
// where a function that does not return is called. SystemC announces a switch to another process. It gives no
// bounds for the main stack, and announces nothing when a process has ended. The definitions here replace
// those of libsystemc and libasan, and add the two missing parts.

#include <dlfcn.h>
#include <pthread.h>
#include <sanitizer/common_interface_defs.h>

#include <cstddef>

namespace {

struct Stack {
  void* bottom = nullptr;
  std::size_t bytes = 0;
};

Stack stack_of_this_thread() {
  Stack stack;
  pthread_attr_t attributes;
  pthread_getattr_np(pthread_self(), &attributes);
  pthread_attr_getstack(&attributes, &stack.bottom, &stack.bytes);
  pthread_attr_destroy(&attributes);
  return stack;
}

// The library's definition of a function that this file defines too.
template <typename Function>
Function* displaced(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

// Determined before sc_main begins.
const Stack kMainStack = stack_of_this_thread();
auto* const kStartSwitch =
    displaced<void(void**, const void*, std::size_t)>("__sanitizer_start_switch_fiber");
auto* const kAbort = displaced<void(void*, void*)>("_ZN7sc_core13sc_cor_pkg_qt5abortEPNS_6sc_corE");

}  // namespace

// NOLINTNEXTLINE(bugprone-reserved-identifier)
extern "C" void __sanitizer_start_switch_fiber(void** fake_stack, const void* bottom, std::size_t bytes) {
  const bool is_main = bottom == nullptr;
  kStartSwitch(fake_stack, is_main ? kMainStack.bottom : bottom, is_main ? kMainStack.bytes : bytes);
}

// Called on the new stack, after a process has ended.
extern "C" void* sc_cor_qt_aborthelp(void* /*old_stack*/, void* /*old_process*/, void* /*unused*/) {
  __sanitizer_finish_switch_fiber(nullptr, nullptr, nullptr);
  return nullptr;
}

namespace sc_core {

// SystemC does not install the header of this class. Declares the members of its sc_cor and sc_cor_qt up to
// the last one that is used.
class sc_cor {
 public:
  void* functions;
  std::size_t stack_bytes;
  void* stack;
};

class sc_cor_pkg_qt {
 public:
  void abort(sc_cor* next);
};

// Ends the running process and switches to `next`: another process, or the main program.
void sc_cor_pkg_qt::abort(sc_cor* next) {
  __sanitizer_start_switch_fiber(nullptr, next->stack, next->stack_bytes);
  kAbort(this, next);
}

}  // namespace sc_core
