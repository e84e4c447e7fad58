#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>

#include "engine/base/error.hpp"
#include "engine/base/json.hpp"
#include "engine/cli/head_server.hpp"
#include "engine/cli/options.hpp"
#include "engine/cli/wii_commands.hpp"
#include "engine/cli/wii_set_up.hpp"
#include "engine/cli/wire_clock.hpp"
#include "engine/session/interrupts.hpp"
#include "engine/session/stop_watch.hpp"
#include "engine/wii/validate.hpp"

namespace verisim::cli {
namespace {

constexpr double kFarewellMax = 2;  // s for clients to take what is still queued
constexpr int kIdleWait = 20;       // ms

struct ServeCommand {
  std::string trace, trajectory, motion;
  SetUpOptions set_up;
  std::string sensor = "wiimote";
  std::string tracker = "geometric";
  HeadDevices devices;
  std::string host = "127.0.0.1";
  std::uint16_t port = vrpn::kDefaultPort;
  double duration = std::numeric_limits<double>::infinity();
  bool wait = false;
  bool json = false;
  bool quiet = false;
  std::uint64_t seed = 1;
  TraceLimits limits;
};

std::unique_ptr<wii::ReportSource> source_of(const ServeCommand& c, const CLI::App& command) {
  const int sources = !c.trace.empty() + !c.trajectory.empty() + !c.motion.empty();
  if (sources != 1) fail(ErrorKind::usage, "wii serve: give one of --trace FILE, --trajectory NAME, --motion FILE");
  if (!c.trace.empty()) {
    refuse_virtual_remote(command, true, "--trace " + c.trace + " is what was seen");
    wii::Recording recording = read_wii_file(c.trace, c.limits);
    if (!c.devices.truth.empty() && recording.truth.empty())
      fail(ErrorKind::input, "{}: no columns px ... qw; --truth needs true poses", c.trace);
    return wii::make_recorded_source(std::move(recording));
  }
  std::vector<FileIdentity> opened;
  wii::VirtualSourceOptions options = {
      .sensor = c.sensor, .leds = wii::find_tracker(c.tracker).leds, .seed = c.seed, .set_up = c.set_up.set_up()};
  if (c.motion.empty())
    options.trajectory = c.trajectory;
  else
    options.motion = read_motion(c.motion, opened);
  return wii::make_virtual_source(options);
}

void tell(vrpn::Server& server, bool quiet) {
  for (const std::string& notice : server.take_notices())
    if (!quiet) std::fprintf(stderr, "%s\n", notice.c_str());
}

struct Served {
  std::uint64_t reports = 0;
  std::uint64_t poses = 0;
};

/// Publishes at the pace of the samples' own times until the source or `duration` ends or Ctrl-C.
Served publish_all(HeadServer& head, wii::ReportSource& source, wii::Tracker& tracker, const ServeCommand& c) {
  Served served;
  const StopWatch watch;
  const vrpn::Timestamp begin = wire_time();
  wii::SensedReport sample;
  while (source.next(sample) && sample.t <= c.duration) {
    for (double left = sample.t - watch.seconds(); left > 0; left = sample.t - watch.seconds()) {
      head.server().turn(wire_time(), static_cast<int>(std::ceil(std::min(left, 1.0) * 1000)));
      tell(head.server(), c.quiet);
      if (was_interrupted()) return served;
    }
    const wii::Report& report = tracker.update(sample.t, sample.channels);
    head.publish(later(begin, std::llround(sample.t * 1e6)), sample, report);
    ++served.reports;
    served.poses += report.valid && report.news ? 1 : 0;
    head.server().turn(wire_time(), 0);
  }
  return served;
}

void wait_for_client(HeadServer& head, bool quiet) {
  while (head.server().ready_clients() == 0 && !was_interrupted()) {
    head.server().turn(wire_time(), kIdleWait);
    tell(head.server(), quiet);
  }
}

/// Lets clients receive their queued messages.
void say_farewell(HeadServer& head, bool quiet) {
  const StopWatch watch;
  do head.server().turn(wire_time(), kIdleWait);
  while (head.server().unsent() > 0 && watch.seconds() < kFarewellMax);
  tell(head.server(), quiet);
}

int serve(const ServeCommand& c, const CLI::App& command) {
  const std::unique_ptr<wii::ReportSource> source = source_of(c, command);
  const std::unique_ptr<wii::Tracker> tracker = wii::make_tracker(c.tracker, source->settings());
  HeadServer head(vrpn::resolve(c.host, c.port), c.devices);
  const InterruptScope until_clients_are_told;
  // On stdout and at once: whoever asked for port 0 reads here which one it became.
  std::FILE* announce = c.json ? stderr : stdout;
  const std::string truth = c.devices.truth.empty() ? "" : " and " + c.devices.truth;
  std::fprintf(announce, "serving %s and %s%s at %s\n", c.devices.tracker.c_str(), c.devices.analog.c_str(),
               truth.c_str(), head.server().address().text().c_str());
  (void)std::fflush(announce);

  if (c.wait) wait_for_client(head, c.quiet);
  const Served served = publish_all(head, *source, *tracker, c);
  say_farewell(head, c.quiet);
  if (c.json) {
    const Json j = {{"port", head.server().address().port},
                    {"reports", served.reports},
                    {"poses", served.poses},
                    {"interrupted", was_interrupted()}};
    std::printf("%s\n", json_text(j).c_str());
  } else if (!c.quiet) {
    std::printf("published %llu reports and %llu poses\n", static_cast<unsigned long long>(served.reports),
                static_cast<unsigned long long>(served.poses));
  }
  return was_interrupted() ? interrupted_exit_code() : 0;
}

}  // namespace

void add_wii_serve(CLI::App& wii_command, int& exit_code) {
  auto* command = wii_command.add_subcommand("serve", "A tracker and its channels as VRPN devices (protocol 07)");
  auto o = std::make_shared<ServeCommand>();
  command->add_option("--trace", o->trace, "Wii trace to play at its own pace, CSV or HDF5");
  command->add_option("--trajectory", o->trajectory, "Or a virtual remote, live: a trajectory of wii validate");
  command->add_option("--motion", o->motion, "Or before a recorded motion of a head: a trace with poses");
  o->set_up.add(*command);
  command->add_option("--sensor", o->sensor, "What that remote is like (see wii validate)")->group(kVirtualRemote);
  command->add_option("--tracker", o->tracker, "Which")->check(CLI::IsMember(trackers_of(1)));
  command->add_option("--device", o->devices.tracker, "Name of the tracker device");
  command->add_option("--channels", o->devices.analog, "Name of the analog device");
  command->add_option("--truth", o->devices.truth, "Name of a second tracker device, with the true poses");
  command->add_option("--host", o->host, "Address to listen at (0.0.0.0: everyone may connect)");
  command->add_option("--port", o->port, "Port, TCP and UDP; 0 takes a free one and says which");
  command->add_option("--duration", o->duration, "End after this many seconds")->check(seconds());
  add_seed_option(
      *command, [o](std::uint64_t seed) { o->seed = seed; }, "Seed of the virtual remote (0 to 2^64 - 1)");
  command->add_flag("--wait", o->wait, "Begin when the first client has connected and asked for a device");
  command->add_flag("--allow-gaps", o->limits.allow_gaps, "Accept gaps longer than 0.1 s in the trace");
  command->add_flag("--resort", o->limits.resort, "Sort the samples of the trace by time first");
  command->add_flag("--json", o->json, "One JSON object on stdout at the end, all else on stderr");
  command->add_flag("--quiet", o->quiet, "Do not say who connects");
  command->footer(
      "Example: verisim wii serve --trace head.csv --tracker scaat\n"
      "         (then vrpn_print_devices Tracker0@localhost)\n"
      "A pose that is not valid is not sent: VRPN cannot mark it. (Stock WiimoteHead sends its last one again.)\n"
      "Stock's own tracker reads these channels with this line in vrpn.cfg; its last number is the distance of the "
      "LEDs\n"
      "in m (without it the generic server takes 0.205, no glasses of this project):\n"
      "         vrpn_Tracker_WiimoteHead Tracker0 WiiMote0@localhost 60.0 0.15");
  command->callback([=, &exit_code] { exit_code = serve(*o, *command); });
}

}  // namespace verisim::cli
