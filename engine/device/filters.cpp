#include "engine/device/filters.hpp"

#include <cmath>

#include "engine/base/error.hpp"
#include "engine/device/forwarding.hpp"

namespace verisim {
namespace {

class ScaleDevice final : public ForwardingDevice {
 public:
  ScaleDevice(std::shared_ptr<Device> device, double scale) : ForwardingDevice(std::move(device)), scale_(scale) {
    update();
  }
  [[nodiscard]] std::string described() const override {
    return fmt::format("{}, scaled by {}", ForwardingDevice::described(), scale_);
  }
  void sample(const DeviceFrame& frame) override {
    ForwardingDevice::sample(frame);
    update();
  }
  [[nodiscard]] const DeviceReading& reading() const override { return reading_; }
  void render(const Wrench& wrench, const DeviceFrame& frame) override {
    ForwardingDevice::render({wrench.force / scale_, wrench.torque}, frame);
  }
  [[nodiscard]] double travel() const override { return scale_ * ForwardingDevice::travel(); }
  [[nodiscard]] double gain() const override { return scale_ * ForwardingDevice::gain(); }
  [[nodiscard]] Workspace workspace() const override {
    const Workspace inner = ForwardingDevice::workspace();
    return {scale_ * inner.min, scale_ * inner.max};
  }

 private:
  void update() {
    reading_ = ForwardingDevice::reading();
    reading_.handle.position *= scale_;
    reading_.velocity.linear *= scale_;
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
  [[nodiscard]] std::string described() const override {
    return fmt::format("{}, translated by ({}, {}, {}) m", ForwardingDevice::described(), translation_.x(),
                       translation_.y(), translation_.z());
  }
  void sample(const DeviceFrame& frame) override {
    ForwardingDevice::sample(frame);
    update();
  }
  [[nodiscard]] const DeviceReading& reading() const override { return reading_; }
  [[nodiscard]] Workspace workspace() const override {
    const Workspace inner = ForwardingDevice::workspace();
    return {inner.min + translation_, inner.max + translation_};
  }

 private:
  void update() {
    reading_ = ForwardingDevice::reading();
    reading_.handle.position += translation_;
  }

  Vector3d translation_;
  DeviceReading reading_;
};

class RotateDevice final : public ForwardingDevice {
 public:
  RotateDevice(std::shared_ptr<Device> device, const Quaterniond& rotation)
      : ForwardingDevice(std::move(device)), rotation_(rotation) {
    update();
  }
  [[nodiscard]] std::string described() const override {
    const Vector3d w = vector_from_rotation(rotation_);
    return fmt::format("{}, rotated by ({}, {}, {}) rad", ForwardingDevice::described(), w.x(), w.y(), w.z());
  }
  void sample(const DeviceFrame& frame) override {
    ForwardingDevice::sample(frame);
    update();
  }
  [[nodiscard]] const DeviceReading& reading() const override { return reading_; }
  void render(const Wrench& wrench, const DeviceFrame& frame) override {
    const Quaterniond back = rotation_.conjugate();
    ForwardingDevice::render({back * wrench.force, back * wrench.torque}, frame);
  }
  /// The box around the turned box.
  [[nodiscard]] Workspace workspace() const override {
    const Workspace inner = ForwardingDevice::workspace();
    if (!inner.min.allFinite() || !inner.max.allFinite()) return {};
    const Vector3d center = rotation_ * Vector3d((inner.min + inner.max) / 2);
    const Vector3d half = rotation_.toRotationMatrix().cwiseAbs() * (inner.max - inner.min) / 2;
    return {center - half, center + half};
  }

 private:
  void update() {
    reading_ = ForwardingDevice::reading();
    reading_.handle = {rotation_ * reading_.handle.position, rotation_ * reading_.handle.rotation};
    reading_.velocity = {rotation_ * reading_.velocity.linear, rotation_ * reading_.velocity.angular};
  }

  Quaterniond rotation_;
  DeviceReading reading_;
};

}  // namespace

std::shared_ptr<Device> make_scale(std::shared_ptr<Device> inner, double scale) {
  VERISIM_ASSERT(inner != nullptr);
  if (!is_positive(scale))
    fail(ErrorKind::input, "device '{}': scale is {} but must be finite and above 0", inner->name(), scale);
  return std::make_shared<ScaleDevice>(std::move(inner), scale);
}

std::shared_ptr<Device> make_translate(std::shared_ptr<Device> inner, const Vector3d& translation) {
  VERISIM_ASSERT(inner != nullptr);
  if (!translation.allFinite()) fail(ErrorKind::input, "device '{}': translation is not finite", inner->name());
  return std::make_shared<TranslateDevice>(std::move(inner), translation);
}

std::shared_ptr<Device> make_rotate(std::shared_ptr<Device> inner, const Quaterniond& rotation) {
  VERISIM_ASSERT(inner != nullptr);
  if (!is_placement({Vector3d::Zero(), rotation}))
    fail(ErrorKind::input, "device '{}': rotation is no unit quaternion", inner->name());
  return std::make_shared<RotateDevice>(std::move(inner), rotation.normalized());
}

}  // namespace verisim
