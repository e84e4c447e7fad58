#include "engine/device/navigator.hpp"

#include "engine/base/error.hpp"
#include "engine/device/forwarding.hpp"

namespace verisim {
namespace {

class CarriedDevice final : public ForwardingDevice {
 public:
  CarriedDevice(std::shared_ptr<Device> device, std::shared_ptr<const Navigator> navigator)
      : ForwardingDevice(std::move(device)), navigator_(std::move(navigator)) {
    reading_ = ForwardingDevice::reading();
    reading_.handle.position += navigator_->displacement;
  }
  [[nodiscard]] std::string described() const override {
    return ForwardingDevice::described() + ", carried by a navigator";
  }
  void sample(const DeviceFrame& frame) override {
    ForwardingDevice::sample(frame);
    reading_ = ForwardingDevice::reading();
    reading_.handle.position += navigator_->displacement;
    if (frame.number > 0) reading_.velocity.linear += (navigator_->displacement - before_) / frame.dt;
    before_ = navigator_->displacement;
  }
  [[nodiscard]] const DeviceReading& reading() const override { return reading_; }
  [[nodiscard]] double travel() const override { return std::numeric_limits<double>::infinity(); }
  [[nodiscard]] Workspace workspace() const override { return {}; }

 private:
  std::shared_ptr<const Navigator> navigator_;
  Vector3d before_ = Vector3d::Zero();
  DeviceReading reading_;
};

}  // namespace

std::shared_ptr<Device> make_carried(std::shared_ptr<Device> inner, std::shared_ptr<const Navigator> navigator) {
  VERISIM_ASSERT(inner != nullptr);
  VERISIM_ASSERT(navigator != nullptr);
  return std::make_shared<CarriedDevice>(std::move(inner), std::move(navigator));
}

}  // namespace verisim
