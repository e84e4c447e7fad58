// A simulation that diverges ends with an error that says when, what and what to do, in the frame in which it happens.
#include <gtest/gtest.h>

#include <limits>

#include "engine/base/error.hpp"
#include "tests/simulation/scenes.hpp"

namespace verisim::diverging_test {
namespace {

/// Stands still, and after some frames is nowhere.
class LostDevice final : public Device {
 public:
  explicit LostDevice(std::uint64_t lost_at) : lost_at_(lost_at) {}
  [[nodiscard]] const std::string& name() const override { return name_; }
  void sample(std::uint64_t frame, double /*t*/, double /*dt*/) override {
    if (frame == lost_at_) reading_.handle.position.y() = std::numeric_limits<double>::quiet_NaN();
  }
  [[nodiscard]] const DeviceReading& reading() const override { return reading_; }
  void render(const Wrench& wrench, double /*dt*/) override { rendered_ = wrench; }
  [[nodiscard]] const Wrench& rendered() const override { return rendered_; }
  [[nodiscard]] double duration() const override { return 0; }
  [[nodiscard]] double travel() const override { return 1; }
  [[nodiscard]] bool driven() const override { return true; }

 private:
  std::string name_ = "lost";
  std::uint64_t lost_at_;
  DeviceReading reading_;
  Wrench rendered_;
};

/// Steps until an Error; its text.
std::string end_of(Simulation& simulation) {
  try {
    while (simulation.frame() < simulation.frames_planned()) simulation.step();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::diverged);
    return error.what();
  }
  ADD_FAILURE() << "it ran to its end";
  return {};
}

TEST(Diverging, NamesTheDeviceThatIsNowhere) {
  Scene scene = scenes::pin_in_hole();
  scene.devices = {std::make_shared<LostDevice>(7)};
  Simulation simulation(scene, {});
  EXPECT_EQ(end_of(simulation), "frame 7: the handle of device 'lost' is not finite");
  EXPECT_EQ(simulation.frame(), 7U) << "the frames before it count";
}

TEST(Diverging, NamesTheBodyThatIsNowhere) {
  for (const Integrator integrator : {Integrator::semi_implicit, Integrator::implicit}) {
    Scene scene = scenes::falling_boxes(1, integrator);
    scene.parameters.gravity.z() = -std::numeric_limits<double>::max();
    scene.bodies[1].density = 1e5;  // a weight beyond the largest number
    Simulation simulation(scene, {});
    EXPECT_EQ(end_of(simulation),
              "frame 0: the state of 'box0' is not finite any more; lower the stiffness or the time step");
  }
}

}  // namespace
}  // namespace verisim::diverging_test
