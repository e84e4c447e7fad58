// This project's exact contacts, with the coupling linearly implicit in the same convex problem (held_pin.hpp).
#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "bench/peers/peer.hpp"

namespace verisim::peers {
namespace {

class Here final : public Peer {
 public:
  Here(const Insertion& task, const Pose& start) : pin_(exact::test::pin_for(task)) { place(start); }
  [[nodiscard]] Motion motion() const override { return {pin_.X_WB, pin_.v, pin_.omega}; }
  Vector3d step(const Hand& hand) override {
    const Vector3d before = pin_.v;
    pin_.step(hand);
    return (pin_.v - before) / kStep - pin_.contact_force;  // the coupling at the step's end: implicit
  }
  void place(const Pose& X) override { pin_.X_WB = X; }
  double query() override {
    const exact::BodyMotion standing;
    const exact::BodyMotion held{pin_.X_WB, pin_.X_WB.position, {}, {}};
    pin_.link.find(standing, held, kStep, pin_.margin);
    double nearest = 1;
    for (const exact::ContactRow& row : pin_.link.rows().rows()) nearest = std::min(nearest, row.gap);
    return -nearest;
  }

 private:
  exact::test::HeldPin pin_;
};

}  // namespace

std::vector<Setting> settings_here() {
  std::vector<Setting> settings;
  for (const double spacing : {0.0045, 0.009, 0.018})
    settings.push_back({.engine = "Verisim",
                        .text = fmt::format("exact, points every {} mm", 1e3 * spacing),
                        .round = true,
                        .make = [spacing](const Insertion& task, const Pose& start) -> std::unique_ptr<Peer> {
                          Insertion finer = task;
                          finer.spacing = spacing;
                          return std::make_unique<Here>(finer, start);
                        }});
  return settings;
}

}  // namespace verisim::peers
