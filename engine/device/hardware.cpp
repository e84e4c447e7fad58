#include "engine/device/hardware.hpp"

#include <cmath>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"

namespace verisim {
namespace {

Vector3d shortened(const Vector3d& v, double limit) {
  const double length = v.norm();
  return length > limit ? Vector3d(v * (limit / length)) : v;
}

class HardwareDevice final : public Device {
 public:
  HardwareDevice(HardwareDescription description, std::shared_ptr<Device> source)
      : description_(std::move(description)), source_(std::move(source)) {
    reading_.raw = reading_.handle = description_.home;
    reading_.button = source_ != nullptr;
  }

  [[nodiscard]] const std::string& name() const override { return description_.name; }

  void sample(std::uint64_t frame, double t, double dt) override {
    if (!source_) return;
    source_->sample(frame, t, dt);
    reading_ = source_->reading();
    reading_.raw.position = quantised(reading_.handle.position);
    reading_.raw.rotation = reading_.handle.rotation;
    reading_.handle = reading_.raw;
  }
  [[nodiscard]] const DeviceReading& reading() const override { return reading_; }

  void render(const Wrench& wrench, double dt) override {
    if (description_.forces)
      rendered_ = {shortened(wrench.force, description_.force_max), shortened(wrench.torque, description_.torque_max)};
    if (source_) source_->render(rendered_, dt);
  }
  [[nodiscard]] const Wrench& rendered() const override { return rendered_; }
  [[nodiscard]] double duration() const override { return source_ ? source_->duration() : 0; }
  [[nodiscard]] double travel() const override {
    // Rounding moves the start and the end by up to half a step per axis, each.
    return source_ ? source_->travel() + std::sqrt(3.0) * description_.resolution : 0;
  }
  [[nodiscard]] bool driven() const override { return source_ != nullptr; }

 private:
  [[nodiscard]] Vector3d quantised(const Vector3d& p) const {
    if (description_.resolution <= 0) return p;
    const Vector3d steps = p / description_.resolution;
    return description_.resolution *
           Vector3d(std::floor(steps.x() + 0.5), std::floor(steps.y() + 0.5), std::floor(steps.z() + 0.5));
  }

  HardwareDescription description_;
  std::shared_ptr<Device> source_;
  DeviceReading reading_;
  Wrench rendered_;
};

}  // namespace

// ORACLES section 4: 3.3 N peak, 0.055 mm, three actuated degrees of freedom.
HardwareDescription phantom_omni(const std::string& name) {
  HardwareDescription omni;
  omni.name = name;
  omni.resolution = 0.000055;
  omni.force_max = 3.3;
  omni.torque_max = 0;
  return omni;
}

// ORACLES section 4: 35 N and 3.1 N m peak.
HardwareDescription virtuose_6d(const std::string& name) {
  HardwareDescription virtuose;
  virtuose.name = name;
  virtuose.force_max = 35;
  virtuose.torque_max = 3.1;
  return virtuose;
}

std::shared_ptr<Device> make_hardware(HardwareDescription description, std::shared_ptr<Device> source) {
  const HardwareDescription& d = description;
  if (!std::isfinite(d.resolution) || d.resolution < 0)
    fail(ErrorKind::input, "device '{}': resolution is {} m but must be finite and not negative", d.name, d.resolution);
  if (!(d.force_max >= 0) || !(d.torque_max >= 0))
    fail(ErrorKind::input, "device '{}': its limits of {} N and {} N m must not be negative", d.name, d.force_max,
         d.torque_max);
  if (!is_placement(d.home))
    fail(ErrorKind::input, "device '{}': its home pose is not finite with a unit quaternion", d.name);
  return std::make_shared<HardwareDevice>(std::move(description), std::move(source));
}

}  // namespace verisim
