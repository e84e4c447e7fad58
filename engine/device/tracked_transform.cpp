#include "engine/device/tracked_transform.hpp"

#include <limits>

#include "engine/device/forwarding.hpp"

namespace verisim {
namespace {

class TrackedTransformDevice final : public ForwardingDevice {
 public:
  TrackedTransformDevice(std::shared_ptr<Device> inner, std::shared_ptr<Device> tracker)
      : ForwardingDevice(std::move(inner)), tracker_(std::move(tracker)) {
    place();
  }
  [[nodiscard]] std::string described() const override {
    return fmt::format("{}, on a base that {} follows", ForwardingDevice::described(), tracker_->described());
  }
  void sample(const DeviceFrame& frame) override {
    tracker_->sample(frame);
    ForwardingDevice::sample(frame);
    const Pose before = reading_.handle;
    const bool base_moved = !is_same(tracker_->reading().handle, base_);
    place();
    // Exactly what the inner device says while the base stands.
    if (base_moved && frame.number > 0) reading_.velocity = velocity_between(before, reading_.handle, frame.dt);
  }
  [[nodiscard]] const DeviceReading& reading() const override { return reading_; }
  void render(const Wrench& wrench, const DeviceFrame& frame) override {
    const Quaterniond back = base_.rotation.conjugate();
    tracker_->render({}, frame);
    ForwardingDevice::render({back * wrench.force, back * wrench.torque}, frame);
  }
  [[nodiscard]] double duration() const override {
    return std::max(ForwardingDevice::duration(), tracker_->duration());
  }
  [[nodiscard]] double travel() const override {
    return tracker_->driven() ? std::numeric_limits<double>::infinity() : ForwardingDevice::travel();
  }
  [[nodiscard]] Workspace workspace() const override {
    return tracker_->driven() ? Workspace() : ForwardingDevice::workspace();
  }
  [[nodiscard]] std::vector<std::string> idle() const override {
    std::vector<std::string> names = ForwardingDevice::idle();
    for (const std::string& name : tracker_->idle()) names.push_back(name);
    return names;
  }
  void declare(Columns& columns) const override {
    ForwardingDevice::declare(columns);
    columns.add("/state/device/" + name() + "/tracked_base", "m, 1", "pose of the base as the tracker says, x y z w",
                [this] { return base_; });
  }
  void report(DeviceNotes& notes) override {
    ForwardingDevice::report(notes);
    tracker_->report(notes);
  }

 private:
  static bool is_same(const Pose& a, const Pose& b) {
    return a.position == b.position && a.rotation.coeffs() == b.rotation.coeffs();
  }
  void place() {
    base_ = tracker_->reading().handle;
    reading_ = ForwardingDevice::reading();
    reading_.handle = {base_.position + base_.rotation * reading_.handle.position,
                       (base_.rotation * reading_.handle.rotation).normalized()};
    reading_.velocity = {base_.rotation * reading_.velocity.linear, base_.rotation * reading_.velocity.angular};
  }

  std::shared_ptr<Device> tracker_;
  Pose base_;  ///< X_WB
  DeviceReading reading_;
};

}  // namespace

std::shared_ptr<Device> make_tracked_transform(std::shared_ptr<Device> inner, std::shared_ptr<Device> tracker) {
  VERISIM_ASSERT(inner != nullptr);
  VERISIM_ASSERT(tracker != nullptr);
  VERISIM_ASSERT(inner != tracker);
  return std::make_shared<TrackedTransformDevice>(std::move(inner), std::move(tracker));
}

}  // namespace verisim
