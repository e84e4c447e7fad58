// What memory is wanted for, in case there is none left: out_of_memory_text() of the program tells it.
#pragma once

#include <string>

namespace verisim {

/// While it lives, memory is wanted for this: "building the scene of pin.lua". The innermost counts.
class MemoryUse {
 public:
  explicit MemoryUse(std::string what);
  ~MemoryUse();
  MemoryUse(const MemoryUse&) = delete;
  MemoryUse& operator=(const MemoryUse&) = delete;

 private:
  std::string outer_;
};

/// The innermost, or the one that an error has left: "this command" if there was none.
[[nodiscard]] const std::string& memory_use();

}  // namespace verisim
