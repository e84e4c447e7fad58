// Counts the program's allocations: a test program that links allocations.cpp has its operator new replaced.
#pragma once

#include <atomic>
#include <cstdint>

namespace verisim {
extern std::atomic<std::uint64_t> allocations;
}
