#include "engine/cli/wii_wire.hpp"

#include <cmath>
#include <cstdio>
#include <limits>

#include "engine/base/error.hpp"
#include "engine/base/text.hpp"
#include "engine/cli/wire_clock.hpp"
#include "engine/session/interrupts.hpp"
#include "engine/session/stop_watch.hpp"
#include "engine/vrpn/client.hpp"
#include "engine/vrpn/payload.hpp"
#include "engine/vrpn/server.hpp"

namespace verisim::cli {
namespace {

constexpr int kWireWait = 5;     // ms
constexpr double kLinger = 0.5;  // s after the last sample in which a pose may still come

/// Both ends of the wire to the tracker elsewhere.
class OtherSide {
 public:
  OtherSide(const std::string& remote_name, const WireOptions& o)
      : options_(o),
        name_(remote_name),
        server_(vrpn::resolve(o.host, o.port), {o.analog}, {std::string(vrpn::kAnalog)}),
        client_(vrpn::parse_remote_name(remote_name), !o.no_udp) {
    std::fprintf(stderr, "serving %s at %s; waiting for %s\n", o.analog.c_str(), server_.address().text().c_str(),
                 remote_name.c_str());
  }

  void wait(double patience_s) {
    const StopWatch watch;
    while (server_.ready_clients() == 0 || !client_.connected()) {
      turn(kWireWait);
      if (watch.seconds() > patience_s)
        fail(ErrorKind::io, "{}: {} within {} s; start it so that it reads {}@{}", name_,
             !client_.connected()     ? "did not answer"
             : server_.clients() == 0 ? "nobody asked for the channels"
                                      : "whoever came did not take the channels",
             patience_s, options_.analog, server_.address().text());
    }
  }

  std::vector<wii::Report> play(const std::vector<wii::SensedReport>& samples) {
    begin_ = wire_time();
    poses_.begin(begin_);
    playing_ = true;
    const double shift = samples.front().t;
    const StopWatch watch;
    for (const wii::SensedReport& s : samples) {
      wait_until(watch, s.t - shift);
      server_.publish(options_.analog, vrpn::kAnalog, later(begin_, std::llround((s.t - shift) * 1e6)),
                      vrpn::encode_analog(s.channels));
      turn(0);
    }
    wait_until(watch, samples.back().t - shift + kLinger);
    say_what_was_left_out();
    std::vector<wii::Report> reports = poses_.reports();
    for (wii::Report& r : reports) r.t += shift;
    return reports;
  }

 private:
  void wait_until(const StopWatch& watch, double t) {
    for (double left = t - watch.seconds(); left > 0; left = t - watch.seconds())
      turn(std::min(kWireWait, static_cast<int>(std::ceil(left * 1000))));
  }

  void turn(int wait_ms) {
    if (was_interrupted()) fail(ErrorKind::interrupted, "wii judge: interrupted");
    server_.turn(wire_time(), 0);
    client_.turn(wire_time(), wait_ms, [&](const vrpn::Received& message) { take(message); });
    for (const std::string& notice : server_.take_notices()) std::fprintf(stderr, "%s\n", notice.c_str());
  }

  void take(const vrpn::Received& message) {
    if (playing_) poses_.take(message);
  }

  void say_what_was_left_out() const {
    if (!poses_.left_out().empty()) std::fprintf(stderr, "%s: left out %s\n", name_.c_str(), poses_.left_out().c_str());
    if (!client_.connected()) std::fprintf(stderr, "%s: left before the end\n", name_.c_str());
  }

  const WireOptions& options_;
  std::string name_;
  vrpn::Server server_;
  vrpn::Client client_;
  bool playing_ = false;  ///< what the tracker says before is of something else
  vrpn::Timestamp begin_;
  HeardPoses poses_;
};

}  // namespace

void HeardPoses::take(const vrpn::Received& message) {
  if (message.type != vrpn::kPose) return;
  const auto pose = vrpn::decode_pose(message.payload);
  if (!pose || pose->sensor != 0) {
    ++of_others_;
    return;
  }
  const auto& [p, q] = pose->placement;
  wii::Report r;
  r.pose = {{p[0], p[1], p[2]}, Quaterniond(q[3], q[0], q[1], q[2]).normalized()};
  if (!r.pose.position.allFinite() || !r.pose.rotation.coeffs().allFinite()) {
    ++not_finite_;
    return;
  }
  if (!begin_) begin_ = message.time;
  r.t = static_cast<double>(microseconds_between(*begin_, message.time)) * 1e-6;
  r.valid = r.news = true;
  r.covariance.setConstant(std::numeric_limits<double>::quiet_NaN());
  if (!reports_.empty() && r.t < reports_.back().t) {
    ++overtaken_;
    return;
  }
  if (!reports_.empty() && r.t == reports_.back().t)
    reports_.back() = r;
  else
    reports_.push_back(r);
}

std::string HeardPoses::left_out() const {
  if (count_left_out() == 0) return "";
  return fmt::format("{} poses of other sensors or malformed, {} not finite, {} overtaken by later ones", of_others_,
                     not_finite_, overtaken_);
}

void WireOptions::add(CLI::App& command) {
  command.add_option("--channels", analog, "Name of the analog device that the other side reads")->group("Wire");
  command.add_option("--serve-host", host, "Address to serve it at")->group("Wire");
  command.add_option("--serve-port", port, "Port to serve it at, TCP and UDP; 0 takes a free one and says which")
      ->group("Wire");
  command.add_flag("--no-udp", no_udp, "Have poses sent by TCP")->group("Wire");
}

std::vector<wii::Report> hear_tracker(const std::string& remote_name, const WireOptions& options, double patience_s,
                                      const std::vector<wii::SensedReport>& samples) {
  const InterruptScope until_it_is_judged;
  OtherSide other(remote_name, options);
  other.wait(patience_s);
  std::vector<wii::Report> reports = other.play(samples);
  if (reports.empty()) fail(ErrorKind::io, "{}: sent no pose of sensor 0 while the remote played", remote_name);
  return reports;
}

}  // namespace verisim::cli
