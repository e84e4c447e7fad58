#include "engine/device/hand/person.hpp"

#include "engine/base/pinned_math.hpp"

namespace verisim {
namespace {

constexpr double kMass = 0.554, kDamping = 6.45, kStiffness = 135;
constexpr double kFactor = 2;
constexpr double kTremorLeast = 0.00005, kTremorMost = 0.00025;  // m rms

}  // namespace

void become(HandDescription& hand) {
  if (hand.arm == ArmKind::given) return;
  hand.mass = kMass;
  hand.damping = kDamping;
  hand.stiffness = kStiffness;
  if (hand.arm == ArmKind::measured) return;
  const RandomStream person(hand.seed, hand.name + " person");
  const auto drawn = [&](std::uint64_t counter, double least, double most) {
    return least * pinned::pow(most / least, person.uniform(counter));
  };
  hand.mass = drawn(0, kMass / kFactor, kMass * kFactor);
  hand.damping = drawn(1, kDamping / kFactor, kDamping * kFactor);
  hand.stiffness = drawn(2, kStiffness / kFactor, kStiffness * kFactor);
  if (hand.tremor == 0) hand.tremor = drawn(3, kTremorLeast, kTremorMost);
}

}  // namespace verisim
