#include "engine/session/memory_use.hpp"

#include <exception>
#include <utility>

namespace verisim {
namespace {

thread_local std::string current_use = "this command";

}  // namespace

MemoryUse::MemoryUse(std::string what) : outer_(std::exchange(current_use, std::move(what))) {}
// An error that leaves keeps the name: it is read where the error is caught.
MemoryUse::~MemoryUse() {
  if (std::uncaught_exceptions() == 0) current_use = std::move(outer_);
}

const std::string& memory_use() {
  return current_use;
}

}  // namespace verisim
