#include "engine/device/hardware.hpp"

#include <cmath>

#include "engine/base/error.hpp"
#include "engine/device/delay_line.hpp"

namespace verisim {
namespace {

constexpr std::size_t kDelayFramesMax = 8192;
constexpr double kStopStiffness = 3000;  // N/m: hard to a hand, and stable with the lightest at 1 kHz

Vector3d shortened(const Vector3d& v, double limit) {
  const double length = v.norm();
  return length > limit ? Vector3d(v * (limit / length)) : v;
}

class HardwareDevice final : public Device {
 public:
  HardwareDevice(HardwareDescription description, std::shared_ptr<Device> source)
      : description_(std::move(description)),
        source_(std::move(source)),
        poses_(description_.delay > 0 ? kDelayFramesMax : 1),
        wrenches_(description_.delay > 0 ? kDelayFramesMax : 1) {
    reading_.raw = reading_.handle = description_.home;
    reading_.button = source_ != nullptr;
    if (source_) source_->carry(description_.load);
  }

  [[nodiscard]] const std::string& name() const override { return description_.name; }
  [[nodiscard]] std::string described() const override {
    const HardwareDescription& d = description_;
    std::string text = source_ ? source_->described() + ", through " : "";
    text += fmt::format("{} ({}", d.name, d.model);
    if (!d.forces) text += ", no forces";
    if (d.forces && std::isfinite(d.force_max)) text += fmt::format(", {} N", d.force_max);
    if (d.forces && d.torque_max == 0) text += ", no torques";
    if (d.forces && d.torque_max > 0 && std::isfinite(d.torque_max)) text += fmt::format(", {} N m", d.torque_max);
    if (d.resolution > 0) text += fmt::format(", steps of {} m", d.resolution);
    if (d.stops) text += ", stops";
    if (d.rate > 0) text += fmt::format(", {} Hz", d.rate);
    if (d.delay > 0) text += fmt::format(", {} s late", d.delay);
    if (d.load.mass > 0) text += fmt::format(", {} kg", d.load.mass);
    if (d.load.friction > 0) text += fmt::format(", friction of {} N", d.load.friction);
    return text + ")";
  }

  void sample(const DeviceFrame& frame) override {
    if (!source_) return;
    source_->sample(frame);
    const DeviceReading& now = source_->reading();
    stop_at_limits(now.handle.position);
    is_due_ = frame.number == 0 || description_.rate <= 0 || comes_due(frame);
    if (is_due_) held_ = {quantised(now.handle.position - beyond_), now.handle.rotation};
    const Pose pose = poses_.put(held_, delay_in_frames(frame.dt));
    reading_.velocity = frame.number == 0 ? Twist() : velocity_between(reading_.handle, pose, frame.dt);
    reading_.raw = reading_.handle = pose;
    reading_.button = now.button;
  }
  [[nodiscard]] const DeviceReading& reading() const override { return reading_; }

  void render(const Wrench& wrench, const DeviceFrame& frame) override {
    const Wrench& commanded = wrenches_.put(wrench, delay_in_frames(frame.dt));
    if (description_.forces && is_due_) {
      rendered_ = {shortened(commanded.force, description_.force_max),
                   shortened(commanded.torque, description_.torque_max)};
      // A device without torques is not saturated by every torque.
      is_saturated_ = commanded.force.norm() > description_.force_max ||
                      (description_.torque_max > 0 && commanded.torque.norm() > description_.torque_max);
    }
    if (source_) source_->render({rendered_.force - kStopStiffness * beyond_, rendered_.torque}, frame);
  }
  [[nodiscard]] const Wrench& rendered() const override { return rendered_; }
  [[nodiscard]] double duration() const override {
    return source_ && source_->duration() > 0 ? source_->duration() + description_.delay : 0;
  }
  [[nodiscard]] double travel() const override {
    // Rounding moves the start and the end by up to half a step per axis, each.
    return source_ ? source_->travel() + std::sqrt(3.0) * description_.resolution : 0;
  }
  [[nodiscard]] bool driven() const override { return source_ != nullptr; }
  void practise(const Practice& practice) override {
    if (source_) source_->practise(practice);
  }
  [[nodiscard]] Workspace workspace() const override { return description_.workspace; }

  void declare(Columns& columns) const override {
    if (source_) source_->declare(columns);
    columns.add("/state/device/" + name() + "/saturated", "1", "1: the motors were asked for more than their peak",
                [this] { return is_saturated_; });
  }
  void report(DeviceNotes& notes) override {
    if (source_) source_->report(notes);
    tell_change(notes, is_saturated_, was_saturated_, "saturation", "is asked for more than its peak",
                "renders all that it is asked for again");
    const bool is_stopped = !beyond_.isZero(0);
    tell_change(notes, is_stopped, was_stopped_, "workspace", "is stopped at its workspace's limit",
                "is within its workspace again");
  }

 private:
  static void tell_change(DeviceNotes& notes, bool is, bool& was, const char* kind, const char* begins,
                          const char* ends) {
    if (is != was) notes.add(kind, is ? begins : ends);
    was = is;
  }

  /// What of a position the workspace does not let through.
  void stop_at_limits(const Vector3d& p) {
    if (!description_.stops) return;
    beyond_ = p - p.cwiseMax(description_.workspace.min).cwiseMin(description_.workspace.max);
  }

  [[nodiscard]] Vector3d quantised(const Vector3d& p) const {
    if (description_.resolution <= 0) return p;
    const Vector3d steps = p / description_.resolution;
    return description_.resolution *
           Vector3d(std::floor(steps.x() + 0.5), std::floor(steps.y() + 0.5), std::floor(steps.z() + 0.5));
  }

  /// The servo's k-th period is due at the first frame whose time is not before k / rate.
  bool comes_due(const DeviceFrame& frame) {
    constexpr double kSame = 1e-9;  // s
    const double period = std::floor((frame.t + kSame) * description_.rate);
    const bool is_new = period > period_;
    period_ = period;
    return is_new;
  }

  [[nodiscard]] std::size_t delay_in_frames(double dt) const {
    if (description_.delay <= 0) return 0;
    const double frames = std::floor(description_.delay / dt + 0.5);
    if (frames >= static_cast<double>(kDelayFramesMax))
      fail(ErrorKind::input, "device '{}': a delay of {} s is {} frames; at most {} are kept", name(),
           description_.delay, frames, kDelayFramesMax - 1);
    return static_cast<std::size_t>(frames);
  }

  HardwareDescription description_;
  std::shared_ptr<Device> source_;
  DelayLine<Pose> poses_;
  DelayLine<Wrench> wrenches_;
  DeviceReading reading_;
  Wrench rendered_;
  Pose held_;                           ///< sampled last
  Vector3d beyond_ = Vector3d::Zero();  ///< m, of the hand, of the stop
  double period_ = 0;
  bool is_due_ = true;
  bool is_saturated_ = false, was_saturated_ = false, was_stopped_ = false;
};

Workspace box_around(const Vector3d& center, const Vector3d& sides) {
  return {center - sides / 2, center + sides / 2};
}

void check(const HardwareDescription& d) {
  const auto require = [&](double value, const char* what, const char* unit) {
    if (!is_not_negative(value))
      fail(ErrorKind::input, "device '{}': {} is {} {} but must be finite and not negative", d.name, what, value, unit);
  };
  require(d.resolution, "resolution", "m");
  require(d.rate, "rate", "Hz");
  require(d.delay, "delay", "s");
  require(d.load.mass, "mass", "kg");
  require(d.load.friction, "friction", "N");
  if (!(d.force_max >= 0) || !(d.torque_max >= 0))
    fail(ErrorKind::input, "device '{}': its limits of {} N and {} N m must not be negative", d.name, d.force_max,
         d.torque_max);
  if (!((d.workspace.max - d.workspace.min).array() > 0).all())
    fail(ErrorKind::input, "device '{}': its workspace is empty", d.name);
  if (!is_placement(d.home))
    fail(ErrorKind::input, "device '{}': its home pose is not finite with a unit quaternion", d.name);
}

}  // namespace

HardwareDescription phantom_omni(const std::string& name) {
  HardwareDescription omni;
  omni.name = name;
  omni.model = "Phantom Omni";
  omni.resolution = 0.000055;
  omni.force_max = 3.3;
  omni.force_continuous = 0.88;
  omni.torque_max = 0;
  omni.workspace = box_around(Vector3d::Zero(), {0.160, 0.120, 0.070});
  return omni;
}

HardwareDescription geomagic_touch(const std::string& name) {
  HardwareDescription touch = phantom_omni(name);
  touch.model = "Geomagic Touch";
  return touch;
}

HardwareDescription virtuose_6d(const std::string& name) {
  HardwareDescription virtuose;
  virtuose.name = name;
  virtuose.model = "Virtuose 6D35-45";
  virtuose.force_max = 35;
  virtuose.force_continuous = 10;
  virtuose.torque_max = 3.1;
  // SPARTA's scripts put the middle of the workspace at (0, 0, 0.55).
  virtuose.workspace = box_around({0, 0, 0.55}, {0.450, 0.450, 0.450});
  return virtuose;
}

HardwareDescription ideal_device(const std::string& name) {
  HardwareDescription ideal;
  ideal.name = name;
  return ideal;
}

std::shared_ptr<Device> make_hardware(HardwareDescription description, std::shared_ptr<Device> source) {
  check(description);
  return std::make_shared<HardwareDevice>(std::move(description), std::move(source));
}

}  // namespace verisim
