// C++ run-time support below main: constructors of static objects, and traps for functions never to be called. There
// is no heap: an allocation stops the board. check_image.cmake proves that newlib's allocator is not even in the image.

#include <cstddef>
#include <new>

#include "boards/zynq7000/faults.h"

using vbar::boards::zynq7000::ExitCode;
using vbar::boards::zynq7000::halt;

namespace {
[[noreturn]] void heap_called() {
  halt("heap call", ExitCode::kHeapCalled);
}
}  // namespace

extern "C" {

// Symbols of zynq7000.ld.
using Constructor = void (*)();
extern const Constructor __init_array_start[];
extern const Constructor __init_array_end[];

// startup.S calls the first before main, and the second should main ever return.
void vbar_construct_statics() {
  for (const Constructor* constructor = __init_array_start; constructor != __init_array_end; ++constructor) {
    (*constructor)();
  }
}
[[noreturn]] void vbar_main_returned() {
  halt("main returned", ExitCode::kAborted);
}

// Destructors of static objects never run: execution ends only by reset.
void* __dso_handle = nullptr;
int __aeabi_atexit(void*, void (*)(void*), void*) {
  return 0;
}
int atexit(void (*)()) {
  return 0;
}

[[noreturn]] void abort() {
  halt("abort", ExitCode::kAborted);
}
[[noreturn]] void __cxa_pure_virtual() {
  halt("pure virtual call", ExitCode::kAborted);
}

struct _reent;
void* malloc(std::size_t) {
  heap_called();
}
void* calloc(std::size_t, std::size_t) {
  heap_called();
}
void* realloc(void*, std::size_t) {
  heap_called();
}
void* memalign(std::size_t, std::size_t) {
  heap_called();
}
void* aligned_alloc(std::size_t, std::size_t) {
  heap_called();
}
void free(void* pointer) {
  if (pointer != nullptr) {
    heap_called();
  }
}
void* _malloc_r(_reent*, std::size_t) {
  heap_called();
}
void* _calloc_r(_reent*, std::size_t, std::size_t) {
  heap_called();
}
void* _realloc_r(_reent*, void*, std::size_t) {
  heap_called();
}
void _free_r(_reent*, void* pointer) {
  free(pointer);
}

}  // extern "C"

void* operator new(std::size_t) {
  heap_called();
}
void* operator new[](std::size_t) {
  heap_called();
}
void operator delete(void* pointer) noexcept {
  free(pointer);
}
void operator delete[](void* pointer) noexcept {
  free(pointer);
}
void operator delete(void* pointer, std::size_t) noexcept {
  free(pointer);
}
void operator delete[](void* pointer, std::size_t) noexcept {
  free(pointer);
}
