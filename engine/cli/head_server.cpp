#include "engine/cli/head_server.hpp"

#include "engine/base/error.hpp"
#include "engine/vrpn/payload.hpp"
#include "engine/wii/admission.hpp"

namespace verisim::cli {
namespace {

std::string checked_name(const std::string& name) {
  if (name.empty() || name.size() > vrpn::kNameMax || name.find('@') != std::string::npos)
    fail(ErrorKind::usage, "device name '{}': must have 1 to {} characters, none of them @", name, vrpn::kNameMax);
  return name;
}

/// Levelled coordinates are the room's; the sensor is the head itself; it may be wherever a report can be.
void answer(const vrpn::Received& request, const vrpn::Server::Reply& reply) {
  constexpr double kReach = wii::kDistanceMax;
  if (request.type == vrpn::kRequestToRoom) reply(vrpn::kToRoom, vrpn::encode(vrpn::Placement{}));
  if (request.type == vrpn::kRequestUnitToSensor) reply(vrpn::kUnitToSensor, vrpn::encode(vrpn::SensorPose{}));
  if (request.type == vrpn::kRequestWorkspace)
    reply(vrpn::kWorkspace, vrpn::encode_box({-kReach, -kReach, 0}, {kReach, kReach, kReach}));
}

}  // namespace

HeadServer::HeadServer(const vrpn::Address& at, HeadDevices devices)
    : devices_(std::move(devices)),
      server_(at, {checked_name(devices_.tracker), checked_name(devices_.analog)},
              {std::string(vrpn::kPose), std::string(vrpn::kAnalog), std::string(vrpn::kToRoom),
               std::string(vrpn::kUnitToSensor), std::string(vrpn::kWorkspace)}) {
  server_.on_request([this](const vrpn::Received& request, const vrpn::Server::Reply& reply) {
    if (request.sender == devices_.tracker) answer(request, reply);
  });
}

void HeadServer::publish(vrpn::Timestamp time, const wii::Channels& channels, const wii::Report& report) {
  server_.publish(devices_.analog, vrpn::kAnalog, time, vrpn::encode_analog(channels));
  if (!report.valid || !report.news) return;
  const Vector3d& p = report.pose.position;
  const auto& q = report.pose.rotation.coeffs();
  const vrpn::SensorPose pose{0, {{p.x(), p.y(), p.z()}, {q[0], q[1], q[2], q[3]}}};
  server_.publish(devices_.tracker, vrpn::kPose, time, vrpn::encode(pose));
}

}  // namespace verisim::cli
