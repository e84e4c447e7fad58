// The choice of Highway's target for the contact kernels. It holds for the whole process: Highway stores it globally.
#include <fmt/ranges.h>

#include <algorithm>
#include "engine/base/error.hpp"
#include "engine/contact/query.hpp"
#include "hwy/highway.h"

namespace verisim {
namespace {

/// What Highway compiles when it uses no SIMD; which of its two portable targets that is depends on the compiler.
constexpr std::int64_t kPortable = HWY_BASELINE_SCALAR;

std::string name_of(std::int64_t target) {
  return target == kPortable ? "scalar" : hwy::TargetName(target);
}

std::vector<std::int64_t> targets() {
  std::int64_t supported = (hwy::SupportedTargets() & HWY_TARGETS) | kPortable;
  std::vector<std::int64_t> list;
  for (; supported != 0; supported &= supported - 1) list.push_back(supported & -supported);  // lowest bit is the best
  return list;
}

}  // namespace

std::vector<std::string> simd_targets() {
  std::vector<std::string> names;
  for (const std::int64_t target : targets()) names.push_back(name_of(target));
  return names;
}

void use_simd_target(const std::string& name) {
  hwy::SetSupportedTargetsForTest(0);
  std::int64_t chosen = 0;
  if (!name.empty()) {
    const auto list = targets();
    const auto found = std::find_if(list.begin(), list.end(), [&](std::int64_t t) { return name_of(t) == name; });
    if (found == list.end()) {
      fail(ErrorKind::usage, "--simd {}: this program and CPU have no such target; choose one of {}", name,
           fmt::join(simd_targets(), ", "));
    }
    chosen = *found;
  }
  hwy::SetSupportedTargetsForTest(chosen);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace verisim
