#include "engine/device/passivity_filter.hpp"

#include <algorithm>

#include "engine/base/error.hpp"
#include "engine/device/forwarding.hpp"

namespace verisim {
namespace {

constexpr double kLever = 0.1;    // m: an angular velocity counts as that of a point so far out
constexpr double kEnergy = 1e-9;  // J: less is rounding

class PassivityDevice final : public ForwardingDevice {
 public:
  PassivityDevice(std::shared_ptr<Device> device, const PassivityDescription& description)
      : ForwardingDevice(std::move(device)), passivity_(description) {}

  [[nodiscard]] std::string described() const override {
    return ForwardingDevice::described() +
           (passivity_.controls ? ", with a passivity controller" : ", with a passivity observer");
  }
  void render(const Wrench& wrench, const DeviceFrame& frame) override {
    const Twist& v = reading().velocity;
    energy_ -= frame.dt * (wrench.force.dot(v.linear) + wrench.torque.dot(v.angular));
    Wrench felt = wrench;
    const double speed2 = v.linear.squaredNorm() + kLever * kLever * v.angular.squaredNorm();
    if (passivity_.controls && energy_ < 0 && speed2 > 0) {
      const double damping = std::min(-energy_ / (frame.dt * speed2), passivity_.damping_max);
      felt.force -= damping * v.linear;
      felt.torque -= damping * kLever * kLever * v.angular;
      energy_ += frame.dt * damping * speed2;
    }
    ForwardingDevice::render(felt, frame);
  }
  void declare(Columns& columns) const override {
    ForwardingDevice::declare(columns);
    columns.add("/state/device/" + name() + "/passivity_energy", "J",
                "energy that the hand gave to what is behind the filter; below 0 that created energy",
                [this] { return energy_; });
  }
  void report(DeviceNotes& notes) override {
    ForwardingDevice::report(notes);
    const bool is_active = energy_ < (is_active_ ? 0 : -kEnergy);
    if (is_active != is_active_)
      notes.add("passivity", is_active ? "gives its hand more energy than it got" : "is passive again");
    is_active_ = is_active;
  }

 private:
  PassivityDescription passivity_;
  double energy_ = 0;  ///< J
  bool is_active_ = false;
};

}  // namespace

std::shared_ptr<Device> make_passivity_filter(std::shared_ptr<Device> inner, const PassivityDescription& p) {
  VERISIM_ASSERT(inner != nullptr);
  if (!is_positive(p.damping_max))
    fail(ErrorKind::input,
         "device '{}': the passivity controller's largest damping is {} but must be finite and above 0", inner->name(),
         p.damping_max);
  return std::make_shared<PassivityDevice>(std::move(inner), p);
}

}  // namespace verisim
