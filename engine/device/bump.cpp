#include "engine/device/bump.hpp"

#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"
#include "engine/device/forwarding.hpp"

namespace verisim {
namespace {

constexpr double kSlow = 1e-3;  // m/s: a handle that is slower has no direction

class BumpDevice final : public ForwardingDevice {
 public:
  BumpDevice(std::shared_ptr<Device> device, const BumpDescription& description)
      : ForwardingDevice(std::move(device)), bump_(description) {}

  [[nodiscard]] std::string described() const override {
    return fmt::format("{}, with a bump of {} N for {} s", ForwardingDevice::described(), bump_.force, bump_.duration);
  }
  void render(const Wrench& wrench, const DeviceFrame& frame) override {
    if (frame.collision_starts) start(wrench, frame.t);
    Wrench felt = wrench;
    const double since = frame.t - begin_;
    if (since < bump_.duration) felt.force += bump_.force * pinned::sin(pinned::kPi * since / bump_.duration) * along_;
    ForwardingDevice::render(felt, frame);
  }

 private:
  void start(const Wrench& wrench, double t) {
    const Vector3d& v = reading().velocity.linear;
    const double force = wrench.force.norm();
    if (v.norm() > kSlow)
      along_ = -v.normalized();
    else if (force > 0)
      along_ = wrench.force / force;
    else
      return;
    begin_ = t;
  }

  BumpDescription bump_;
  double begin_ = -std::numeric_limits<double>::infinity();
  Vector3d along_ = Vector3d::Zero();
};

}  // namespace

std::shared_ptr<Device> make_bump(std::shared_ptr<Device> inner, const BumpDescription& bump) {
  VERISIM_ASSERT(inner != nullptr);
  if (!is_positive(bump.force) || !is_positive(bump.duration))
    fail(ErrorKind::input, "device '{}': a bump of {} N for {} s; both must be finite and above 0", inner->name(),
         bump.force, bump.duration);
  return std::make_shared<BumpDevice>(std::move(inner), bump);
}

}  // namespace verisim
