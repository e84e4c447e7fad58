#include <cmath>

#include "engine/base/error.hpp"
#include "engine/device/forwarding.hpp"
#include "engine/device/hardware.hpp"

namespace verisim {
namespace {

class ScaleDevice final : public ForwardingDevice {
 public:
  ScaleDevice(std::shared_ptr<Device> device, double scale) : ForwardingDevice(std::move(device)), scale_(scale) {
    update();
  }
  void sample(std::uint64_t frame, double t, double dt) override {
    ForwardingDevice::sample(frame, t, dt);
    update();
  }
  [[nodiscard]] const DeviceReading& reading() const override { return reading_; }
  void render(const Wrench& wrench, double dt) override {
    ForwardingDevice::render({wrench.force / scale_, wrench.torque}, dt);
  }
  [[nodiscard]] double travel() const override { return scale_ * ForwardingDevice::travel(); }

 private:
  void update() {
    reading_ = ForwardingDevice::reading();
    reading_.handle.position *= scale_;
  }

  double scale_;
  DeviceReading reading_;
};

class TranslateDevice final : public ForwardingDevice {
 public:
  TranslateDevice(std::shared_ptr<Device> device, Vector3d translation)
      : ForwardingDevice(std::move(device)), translation_(std::move(translation)) {
    update();
  }
  void sample(std::uint64_t frame, double t, double dt) override {
    ForwardingDevice::sample(frame, t, dt);
    update();
  }
  [[nodiscard]] const DeviceReading& reading() const override { return reading_; }

 private:
  void update() {
    reading_ = ForwardingDevice::reading();
    reading_.handle.position += translation_;
  }

  Vector3d translation_;
  DeviceReading reading_;
};

}  // namespace

std::shared_ptr<Device> make_scale(std::shared_ptr<Device> inner, double scale) {
  VERISIM_ASSERT(inner != nullptr);
  if (!std::isfinite(scale) || scale <= 0)
    fail(ErrorKind::input, "device '{}': scale is {} but must be finite and above 0", inner->name(), scale);
  return std::make_shared<ScaleDevice>(std::move(inner), scale);
}

std::shared_ptr<Device> make_translate(std::shared_ptr<Device> inner, const Vector3d& translation) {
  VERISIM_ASSERT(inner != nullptr);
  if (!translation.allFinite()) fail(ErrorKind::input, "device '{}': translation is not finite", inner->name());
  return std::make_shared<TranslateDevice>(std::move(inner), translation);
}

}  // namespace verisim
