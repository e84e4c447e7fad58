// `off`: the penalty forces of the voxels, as they are.
#include "engine/simulation/hybrid_method.hpp"

namespace verisim {
namespace {

class Off final : public HybridMethod {
 public:
  constexpr Off() : HybridMethod("off", 0) {}
  [[nodiscard]] bool needs_entities() const override { return false; }
  [[nodiscard]] std::unique_ptr<PairMethod> make(const Pair& /*pair*/) const override { return nullptr; }
};

constinit const Off kOff;

}  // namespace

constinit const Hybrid hybrid::off = &kOff;

}  // namespace verisim
