#include "engine/device/mobile_base.hpp"

#include <limits>

#include "engine/device/forwarding.hpp"

namespace verisim {
namespace {

class MountedDevice final : public ForwardingDevice {
 public:
  MountedDevice(std::shared_ptr<Device> source, std::shared_ptr<MovingBase> base)
      : ForwardingDevice(std::move(source)), base_(std::move(base)) {
    VERISIM_ASSERT(base_ != nullptr);
    place();
  }
  [[nodiscard]] std::string described() const override {
    return fmt::format("{}, walking beside a base that moves", ForwardingDevice::described());
  }
  void sample(const DeviceFrame& frame) override {
    ForwardingDevice::sample(frame);
    const Pose before = reading_.handle;
    place();
    reading_.velocity = frame.number == 0 ? Twist() : velocity_between(before, reading_.handle, frame.dt);
  }
  [[nodiscard]] const DeviceReading& reading() const override { return reading_; }
  void render(const Wrench& wrench, const DeviceFrame& frame) override {
    base_->load(reaction(wrench, reading_.handle.position, Vector3d::Zero()));
    const Quaterniond& R_WB = base_->pose().rotation;
    ForwardingDevice::render({R_WB * wrench.force, R_WB * wrench.torque}, frame);
  }
  /// Of the handle in B: the base goes along, and nobody knows how far it stays behind.
  [[nodiscard]] double travel() const override { return std::numeric_limits<double>::infinity(); }
  [[nodiscard]] Workspace workspace() const override { return {}; }

 private:
  void place() {
    reading_ = ForwardingDevice::reading();
    reading_.raw = reading_.handle = base_->pose().inverse() * reading_.handle;
  }

  std::shared_ptr<MovingBase> base_;
  DeviceReading reading_;
};

class RemoteBase final : public ForwardingDevice {
 public:
  RemoteBase(std::shared_ptr<Device> inner, std::shared_ptr<MovingBase> base, RemoteBaseDescription description)
      : ForwardingDevice(std::move(inner)), base_(std::move(base)), description_(std::move(description)) {
    VERISIM_ASSERT(base_ != nullptr);
    VERISIM_ASSERT(description_.gain != nullptr);
    VERISIM_ASSERT(std::isfinite(description_.neutral_x));
    VERISIM_ASSERT(std::isfinite(description_.neutral_z));
  }
  [[nodiscard]] std::string described() const override {
    return fmt::format("{}, driving {} from ({}, {})", ForwardingDevice::described(), description_.server,
                       description_.neutral_x, description_.neutral_z);
  }
  void sample(const DeviceFrame& frame) override {
    ForwardingDevice::sample(frame);
    const Vector3d& p = reading().handle.position;
    error_ = {p.x() - description_.neutral_x, p.z() - description_.neutral_z};
    base_->follow(*description_.gain * error_[0], *description_.gain * error_[1]);
  }
  void render(const Wrench& wrench, const DeviceFrame& frame) override {
    ForwardingDevice::render({wrench.force + base_->limit(), wrench.torque}, frame);
  }
  void declare(Columns& columns) const override {
    ForwardingDevice::declare(columns);
    columns.add("/state/device/" + name() + "/base_error", "m",
                "handle from the neutral place, along x and z of the base", [this] { return error_; });
  }

 private:
  std::shared_ptr<MovingBase> base_;
  RemoteBaseDescription description_;
  std::array<double, 2> error_{};
};

class BaseTracker final : public Device {
 public:
  BaseTracker(std::string name, std::shared_ptr<MovingBase> base) : name_(std::move(name)), base_(std::move(base)) {
    VERISIM_ASSERT(base_ != nullptr);
    reading_.raw = reading_.handle = base_->tracked_pose();
  }
  [[nodiscard]] const std::string& name() const override { return name_; }
  [[nodiscard]] std::string described() const override { return name_ + " (tracker of the base)"; }
  void sample(const DeviceFrame& frame) override {
    const Pose& pose = base_->tracked_pose();
    reading_.velocity = frame.number == 0 ? Twist() : velocity_between(reading_.handle, pose, frame.dt);
    reading_.raw = reading_.handle = pose;
  }
  [[nodiscard]] const DeviceReading& reading() const override { return reading_; }
  void render(const Wrench& /*wrench*/, const DeviceFrame& /*frame*/) override {}
  [[nodiscard]] const Wrench& rendered() const override { return nothing_; }
  [[nodiscard]] double duration() const override { return 0; }
  [[nodiscard]] double travel() const override { return std::numeric_limits<double>::infinity(); }
  [[nodiscard]] bool driven() const override { return true; }

 private:
  std::string name_;
  std::shared_ptr<MovingBase> base_;
  DeviceReading reading_;
  Wrench nothing_;
};

}  // namespace

std::shared_ptr<Device> make_mounted(std::shared_ptr<Device> source, std::shared_ptr<MovingBase> base) {
  return std::make_shared<MountedDevice>(std::move(source), std::move(base));
}

std::shared_ptr<Device> make_remote_base(std::shared_ptr<Device> inner, std::shared_ptr<MovingBase> base,
                                         RemoteBaseDescription description) {
  return std::make_shared<RemoteBase>(std::move(inner), std::move(base), std::move(description));
}

std::shared_ptr<Device> make_base_tracker(std::string name, std::shared_ptr<MovingBase> base) {
  return std::make_shared<BaseTracker>(std::move(name), std::move(base));
}

}  // namespace verisim
