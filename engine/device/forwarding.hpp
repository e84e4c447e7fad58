// The base of everything that wraps a device: forwards all calls (dissertation section 4.3.1); a filter overrides what
// it changes.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "engine/base/error.hpp"
#include "engine/device/device.hpp"

namespace verisim {

class ForwardingDevice : public Device {
 public:
  /// @pre inner is not null
  explicit ForwardingDevice(std::shared_ptr<Device> inner) : inner_(std::move(inner)) {
    VERISIM_ASSERT(inner_ != nullptr);
  }
  [[nodiscard]] const std::string& name() const override { return inner_->name(); }
  [[nodiscard]] std::string described() const override { return inner_->described(); }
  void sample(const DeviceFrame& frame) override { inner_->sample(frame); }
  [[nodiscard]] const DeviceReading& reading() const override { return inner_->reading(); }
  void render(const Wrench& wrench, const DeviceFrame& frame) override { inner_->render(wrench, frame); }
  [[nodiscard]] const Wrench& rendered() const override { return inner_->rendered(); }
  [[nodiscard]] double duration() const override { return inner_->duration(); }
  [[nodiscard]] double travel() const override { return inner_->travel(); }
  [[nodiscard]] bool driven() const override { return inner_->driven(); }
  [[nodiscard]] std::vector<std::string> idle() const override { return inner_->idle(); }
  [[nodiscard]] Workspace workspace() const override { return inner_->workspace(); }
  void carry(const HandleLoad& load) override { inner_->carry(load); }
  [[nodiscard]] double gain() const override { return inner_->gain(); }
  void practise(const Practice& practice) override { inner_->practise(practice); }
  void declare(Columns& columns) const override { inner_->declare(columns); }
  void report(DeviceNotes& notes) override { inner_->report(notes); }

 private:
  std::shared_ptr<Device> inner_;
};

}  // namespace verisim
