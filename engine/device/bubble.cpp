#include "engine/device/bubble.hpp"

#include <cmath>

#include "engine/base/error.hpp"
#include "engine/device/collision_start.hpp"
#include "engine/device/forwarding.hpp"

namespace verisim {
namespace {

class BubbleDevice final : public ForwardingDevice {
 public:
  BubbleDevice(std::shared_ptr<Device> device, const BubbleDescription& description,
               std::shared_ptr<Navigator> navigator)
      : ForwardingDevice(std::move(device)),
        bubble_(description),
        navigator_(std::move(navigator)),
        collisions_(description.clear) {
    place(ForwardingDevice::reading());
  }

  [[nodiscard]] std::string described() const override {
    const BubbleDescription& b = bubble_;
    return fmt::format("{}, in a bubble of {} m ({} law, scale {}{}{})", ForwardingDevice::described(), b.radius,
                       kBubbleLawNames[static_cast<std::size_t>(b.law.kind)], b.law.scale,
                       b.elastic ? fmt::format(", {} N/m", b.stiffness) : ", no spring",
                       b.stops_in_collision ? ", stops in collision" : "");
  }

  void sample(const DeviceFrame& frame) override {
    if (frame.number > 0) move(frame.dt);
    ForwardingDevice::sample(frame);
    place(ForwardingDevice::reading());
    if (frame.number > 0) reading_.velocity.linear += (navigator_->displacement - before_) / frame.dt;
    before_ = navigator_->displacement;
    leave(ForwardingDevice::reading().handle.position - bubble_.center);
  }
  [[nodiscard]] const DeviceReading& reading() const override { return reading_; }

  void render(const Wrench& wrench, const DeviceFrame& frame) override {
    collisions_.add(frame.t, frame.collisions);
    Wrench felt = wrench;
    if (bubble_.elastic) felt.force -= bubble_.stiffness * outside_ * away_;
    ForwardingDevice::render(felt, frame);
  }
  [[nodiscard]] double travel() const override { return std::numeric_limits<double>::infinity(); }
  void practise(const Practice& practice) override {
    Practice within = practice;
    within.edge = std::min(practice.edge, bubble_.radius / ForwardingDevice::gain());
    ForwardingDevice::practise(within);
  }
  [[nodiscard]] Workspace workspace() const override { return {}; }

  void declare(Columns& columns) const override {
    ForwardingDevice::declare(columns);
    const std::string path = "/state/device/" + name();
    columns.add(path + "/bubble_center", "m", "centre of the bubble in the coordinates of the handle behind it",
                [this] {
                  const Vector3d center = bubble_.center + navigator_->displacement;
                  return std::array{center.x(), center.y(), center.z()};
                });
    columns.add(path + "/bubble_velocity", "m/s", "rate of the bubble", [this] {
      return std::array{velocity_.x(), velocity_.y(), velocity_.z()};
    });
    columns.add(path + "/outside", "1", "1: the handle is outside of the bubble", [this] { return outside_ > 0; });
  }
  void report(DeviceNotes& notes) override {
    ForwardingDevice::report(notes);
    const bool is_outside = outside_ > 0;
    if (is_outside != was_outside_)
      notes.add("bubble", is_outside ? "leaves its bubble, which moves" : "is back in its bubble");
    was_outside_ = is_outside;
    const bool is_stopped = is_outside && is_held();
    if (is_stopped != was_stopped_)
      notes.add("bubble", is_stopped ? "touches something, its bubble stops" : "touches nothing, its bubble may move");
    was_stopped_ = is_stopped;
  }

 private:
  [[nodiscard]] bool is_held() const { return bubble_.stops_in_collision && collisions_.value() > 0; }

  /// The step of the bubble, with the rate of the last frame.
  void move(double dt) {
    if (!navigator_->paused) navigator_->displacement += dt * velocity_;
  }
  void place(const DeviceReading& inner) {
    reading_ = inner;
    reading_.handle.position += navigator_->displacement;
  }
  /// What a handle that is d from the centre does to the bubble.
  void leave(const Vector3d& d) {
    const double distance = d.norm();
    outside_ = std::max(0.0, distance - bubble_.radius);
    away_ = outside_ > 0 ? Vector3d(d / distance) : Vector3d::Zero();
    velocity_ = is_held() || navigator_->paused
                    ? Vector3d::Zero()
                    : Vector3d(bubble_.law.rate(outside_, bubble_.radius) * away_.cwiseProduct(bubble_.moves));
  }

  BubbleDescription bubble_;
  std::shared_ptr<Navigator> navigator_;
  ShortTermMaximum collisions_;
  Vector3d before_ = Vector3d::Zero();    ///< m, displacement in the frame before
  Vector3d velocity_ = Vector3d::Zero();  ///< m/s, of the bubble
  Vector3d away_ = Vector3d::Zero();      ///< unit, from the centre; 0 inside
  double outside_ = 0;                    ///< m, x
  bool was_outside_ = false, was_stopped_ = false;
  DeviceReading reading_;
};

}  // namespace

std::shared_ptr<Device> make_bubble(std::shared_ptr<Device> inner, const BubbleDescription& b,
                                    std::shared_ptr<Navigator> navigator) {
  VERISIM_ASSERT(inner != nullptr);
  const auto require = [&](double value, const char* what) {
    if (!is_positive(value))
      fail(ErrorKind::input, "device '{}': the bubble's {} is {} but must be finite and above 0", inner->name(), what,
           value);
  };
  require(b.radius, "radius");
  require(b.stiffness, "stiffness");
  require(b.law.scale, "velocity scale");
  require(b.law.peak, "peak");
  require(b.law.taper, "taper");
  require(b.clear, "clear");
  if (!(b.law.taper < 1))
    fail(ErrorKind::input, "device '{}': the bubble's taper is {} but must be below 1", inner->name(), b.law.taper);
  const Workspace workspace = inner->workspace();
  if (!b.center.allFinite() || !workspace.contains(b.center))
    fail(ErrorKind::input,
         "device '{}': the bubble's centre ({}, {}, {}) is outside of the device's workspace, ({}, {}, {}) to ({}, {}, "
         "{}) m",
         inner->name(), b.center.x(), b.center.y(), b.center.z(), workspace.min.x(), workspace.min.y(),
         workspace.min.z(), workspace.max.x(), workspace.max.y(), workspace.max.z());
  for (const double axis : b.moves)
    if (axis != 0 && axis != 1)
      fail(ErrorKind::input, "device '{}': a bubble moves along an axis (1) or not (0), not {}", inner->name(), axis);
  if (!navigator) navigator = std::make_shared<Navigator>();
  return std::make_shared<BubbleDevice>(std::move(inner), b, std::move(navigator));
}

}  // namespace verisim
