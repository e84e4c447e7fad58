#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>

#include "engine/base/error.hpp"
#include "engine/base/text.hpp"
#include "engine/cli/options.hpp"
#include "engine/cli/wii_commands.hpp"
#include "engine/cli/wire_clock.hpp"
#include "engine/record/output_place.hpp"
#include "engine/script/wii_recording.hpp"
#include "engine/session/interrupts.hpp"
#include "engine/session/json_text.hpp"
#include "engine/session/stop_watch.hpp"
#include "engine/vrpn/client.hpp"
#include "engine/vrpn/payload.hpp"

namespace verisim::cli {
namespace {

constexpr int kWait = 50;  // ms

struct ListenCommand {
  std::string remote, poses;
  OutOptions out;
  std::string tracker = "geometric";
  std::string leds;
  std::vector<double> fov;
  double rate = 100;
  double duration = std::numeric_limits<double>::infinity();
  double patience = 10;
  bool no_udp = false;
  bool json = false;
};

/// Analog reports as they come, in the form of a wii trace.
class ChannelRecord {
 public:
  explicit ChannelRecord(const ListenCommand& c) {
    trace_.kind = "wii";
    trace_.rate_hz = c.rate;
    trace_.source = "VRPN " + c.remote;
    if (!c.leds.empty()) trace_.extra["leds"] = c.leds;
    if (!c.fov.empty()) trace_.extra["fov_deg"] = fmt::format("{} {}", c.fov[0], c.fov[1]);
    trace_.columns = wii_trace_columns();
  }

  /// Adds a report to the trace. A report is counted and left out if it has fewer than 15 channels, is not finite, or
  /// is not later than the last one.
  void add(const vrpn::Received& message) {
    const auto analog = vrpn::decode_analog(message.payload);
    if (trace_.values.empty()) begin_ = message.time;
    const std::int64_t t = microseconds_between(begin_, message.time);
    if (!analog || analog->count < wii::kChannelsMin || t <= last_t_ || !finite(*analog)) {
      ++left_out_;
      return;
    }
    last_t_ = t;
    trace_.values.push_back(static_cast<double>(t) * 1e-6);
    for (std::size_t i = 0; i < wii::kChannels; ++i)
      trace_.values.push_back(i < analog->count ? analog->values[i] : -1);  // 15 channels: slot 3 has no size
  }

  [[nodiscard]] const Trace& trace() const { return trace_; }
  [[nodiscard]] std::uint64_t left_out() const { return left_out_; }

 private:
  [[nodiscard]] static bool finite(const vrpn::Analog& analog) {
    const auto channels = analog.channels().first(std::min<std::size_t>(analog.count, wii::kChannels));
    return std::all_of(channels.begin(), channels.end(), [](double x) { return std::isfinite(x); });
  }

  Trace trace_;
  vrpn::Timestamp begin_;
  std::int64_t last_t_ = -1;
  std::uint64_t left_out_ = 0;
};

/// Until the server leaves, the time is up, or Ctrl-C. Error(io) if no server answers.
void listen_to(vrpn::Client& client, const ListenCommand& c, ChannelRecord& record) {
  const StopWatch watch;
  bool was_connected = false;
  while (!was_interrupted() && watch.seconds() < c.duration) {
    client.turn(wire_time(), kWait, [&](const vrpn::Received& message) {
      if (message.type == vrpn::kAnalog) record.add(message);
      if (message.type == vrpn::kText)
        if (const auto text = vrpn::decode_text(message.payload); text && text->severity > 0)
          std::fprintf(stderr, "%s: %s\n", c.remote.c_str(), shown(text->text).c_str());
    });
    if (was_connected && !client.connected()) return;
    was_connected = was_connected || client.connected();
    if (!was_connected && watch.seconds() > c.patience)
      fail(ErrorKind::io, "{}: no VRPN server answered within {} s{}; start it, or check host and port", c.remote,
           c.patience, client.last_loss().empty() ? "" : " (" + client.last_loss() + ")");
  }
}

std::string poses_of(const wii::Recording& recording, const std::string& tracker_name) {
  const std::unique_ptr<wii::Tracker> tracker = wii::make_tracker(tracker_name, recording.settings);
  std::string text = kPoseHeader;
  for (std::size_t i = 0; i < recording.t.size(); ++i)
    text += pose_row(recording.t[i], tracker->update(recording.t[i], recording.channels[i]));
  return text;
}

int listen(const ListenCommand& c) {
  if (c.out.path.empty() && c.poses.empty())
    fail(ErrorKind::usage, "wii listen: nothing to write; give -o TRACE, --poses CSV, or both");
  if (c.out.path == c.poses)
    fail(ErrorKind::usage, "wii listen: -o and --poses both name {}; give each a file of its own", c.poses);
  ChannelRecord record(c);
  wii::TrackerSettings settings =
      wii_settings_of(c.remote, record.trace());  // doubts --leds and --fov before listening
  if (!c.poses.empty()) (void)wii::make_tracker(c.tracker, settings);
  const std::string out = c.out.path.empty() ? "" : check_output({c.out.path, OutputKind::trace, c.out.force, {}});
  if (!c.poses.empty()) (void)check_output({c.poses, OutputKind::text, c.out.force, kPoseHeader});
  vrpn::Client client(vrpn::parse_remote_name(c.remote), !c.no_udp);
  const InterruptScope until_it_is_written;
  listen_to(client, c, record);

  const std::size_t reports = record.trace().rows();
  if (reports == 0 && was_interrupted()) return interrupted_exit_code();
  if (reports == 0)
    fail(ErrorKind::input, "{}: no report with {} channels came ({} others did); is it the analog device?", c.remote,
         wii::kChannelsMin, record.left_out());
  if (!out.empty()) write_trace(out, record.trace());
  if (!c.poses.empty())
    write_text(c.poses, poses_of(wii_recording_of(c.remote, record.trace()), c.tracker), c.out.force);
  if (c.json) {
    const nlohmann::ordered_json j = {
        {"reports", reports}, {"left_out", record.left_out()}, {"interrupted", was_interrupted()}};
    std::printf("%s\n", json_text(j).c_str());
  } else {
    std::printf("took %zu reports; %llu could not be kept\n", reports,
                static_cast<unsigned long long>(record.left_out()));
  }
  return was_interrupted() ? interrupted_exit_code() : 0;
}

}  // namespace

void add_wii_listen(CLI::App& wii_command, int& exit_code) {
  auto* command = wii_command.add_subcommand("listen", "Takes channels from a VRPN server: a trace, poses, or both");
  auto o = std::make_shared<ListenCommand>();
  command->add_option("DEVICE", o->remote, "WiiMote0@HOST, WiiMote0@HOST:PORT, or WiiMote0@tcp://HOST:PORT")
      ->required();
  add_out_options(*command, o->out, "Wii trace to write, .csv or .h5; only a trace is replaced");
  command->add_option("--poses", o->poses, "CSV of a tracker's poses, as wii track writes it");
  command->add_option("--tracker", o->tracker, "Which tracker")->check(CLI::IsMember(trackers_of(1)));
  command->add_option("--leds", o->leds, "LEDs of the glasses, as in a trace: 'x y z; x y z'");
  command->add_option("--fov", o->fov, "Field of view of that remote, degrees")->expected(2);
  command->add_option("--rate", o->rate, "Nominal rate to write into the trace, 1/s")->check(CLI::PositiveNumber);
  command->add_option("--duration", o->duration, "Stop after this many seconds")->check(seconds());
  command->add_option("--patience", o->patience, "Give up if no server answers for so many seconds")->check(seconds());
  command->add_flag("--no-udp", o->no_udp, "Have reports sent by TCP");
  command->add_flag("--json", o->json, "One JSON object on stdout at the end");
  command->footer("Example: verisim wii listen WiiMote0@localhost -o head.csv --duration 30");
  command->callback([=, &exit_code] { exit_code = listen(*o); });
}

}  // namespace verisim::cli
