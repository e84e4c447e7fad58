#include "engine/cli/memory_wanted.hpp"

#include <fmt/format.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "engine/session/memory_use.hpp"

namespace {

std::atomic<std::size_t> refused_bytes = 0;

#ifndef VERISIM_SANITIZED  // which has an operator new of its own
void* allocate(std::size_t bytes, std::size_t alignment) {
  void* memory = nullptr;
  if (alignment <= __STDCPP_DEFAULT_NEW_ALIGNMENT__)
    memory = std::malloc(bytes == 0 ? 1 : bytes);
  else if (bytes <= SIZE_MAX - alignment)
    memory = std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
  if (memory == nullptr) refused_bytes = bytes;
  return memory;
}

void* allocate_or_throw(std::size_t bytes, std::size_t alignment) {
  void* memory = allocate(bytes, alignment);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}
#endif

std::string with_unit(double bytes) {
  return bytes < 1e9 ? fmt::format("{:.1f} MB", bytes / 1e6) : fmt::format("{:.1f} GB", bytes / 1e9);
}

}  // namespace

#ifndef VERISIM_SANITIZED
void* operator new(std::size_t bytes) {
  return allocate_or_throw(bytes, 1);
}
void* operator new(std::size_t bytes, std::align_val_t alignment) {
  return allocate_or_throw(bytes, static_cast<std::size_t>(alignment));
}
void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept {
  return allocate(bytes, 1);
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  std::free(memory);
}
void operator delete(void* memory, const std::nothrow_t&) noexcept {
  std::free(memory);
}
#endif

namespace verisim::cli {

std::string out_of_memory_text() {
  const std::size_t bytes = refused_bytes;
  const std::string amount = bytes > 0 ? with_unit(static_cast<double>(bytes)) + " more" : "more than there is";
  return fmt::format(
      "out of memory: {} wanted {}; make it smaller (larger voxels, fewer parts, a shorter duration) or "
      "use a machine with more memory",
      memory_use(), amount);
}

}  // namespace verisim::cli
