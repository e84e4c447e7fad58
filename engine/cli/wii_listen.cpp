#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>

#include "engine/base/error.hpp"
#include "engine/base/json.hpp"
#include "engine/base/text.hpp"
#include "engine/cli/options.hpp"
#include "engine/cli/wii_commands.hpp"
#include "engine/cli/wii_wire.hpp"
#include "engine/cli/wire_clock.hpp"
#include "engine/record/output_place.hpp"
#include "engine/script/wii_recording.hpp"
#include "engine/session/interrupts.hpp"
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
  std::vector<std::string> of_channels;  ///< given options that poses have no use for
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
    if (!analog || analog->count < wii::kChannelsMin) {
      ++too_few_;
      return;
    }
    if (!finite(*analog)) {
      ++not_finite_;
      return;
    }
    if (trace_.values.empty()) begin_ = message.time;
    const std::int64_t t = microseconds_between(begin_, message.time);
    if (t <= last_t_) {
      ++not_later_;
      return;
    }
    last_t_ = t;
    trace_.values.push_back(static_cast<double>(t) * 1e-6);
    for (std::size_t i = 0; i < wii::kChannels; ++i)
      trace_.values.push_back(i < analog->count ? analog->values[i] : -1);  // 15 channels: slot 3 has no size
  }

  [[nodiscard]] const Trace& trace() const { return trace_; }
  [[nodiscard]] std::uint64_t count_left_out() const { return too_few_ + not_finite_ + not_later_; }
  [[nodiscard]] std::string left_out() const {
    if (count_left_out() == 0) return "";
    return fmt::format("{} reports with fewer than {} channels, {} not finite, {} not later than the one before",
                       too_few_, wii::kChannelsMin, not_finite_, not_later_);
  }

 private:
  [[nodiscard]] static bool finite(const vrpn::Analog& analog) {
    const auto channels = analog.channels().first(std::min<std::size_t>(analog.count, wii::kChannels));
    return std::all_of(channels.begin(), channels.end(), [](double x) { return std::isfinite(x); });
  }

  Trace trace_;
  vrpn::Timestamp begin_;
  std::int64_t last_t_ = -1;
  std::uint64_t too_few_ = 0, not_finite_ = 0, not_later_ = 0;
};

/// What was heard: a remote's channels or a tracker's poses.
struct Heard {
  explicit Heard(const ListenCommand& c) : channels(c) {}
  ChannelRecord channels;
  HeardPoses poses;

  /// Channels, or else poses.
  [[nodiscard]] std::size_t reports() const {
    return channels.trace().rows() > 0 ? channels.trace().rows() : poses.reports().size();
  }
  [[nodiscard]] std::uint64_t count_left_out() const {
    return channels.count_left_out() + static_cast<std::uint64_t>(poses.count_left_out());
  }
  [[nodiscard]] std::string left_out() const {
    const std::string a = channels.left_out(), b = poses.left_out();
    return a.empty() || b.empty() ? a + b : a + "; " + b;
  }
};

/// Until the server leaves, the time is up, or Ctrl-C: returns which. Error(io) if no server answers.
std::string listen_to(vrpn::Client& client, const ListenCommand& c, Heard& heard) {
  const StopWatch watch;
  bool was_connected = false;
  while (!was_interrupted() && watch.seconds() < c.duration) {
    client.turn(wire_time(), kWait, [&](const vrpn::Received& message) {
      if (message.type == vrpn::kAnalog) heard.channels.add(message);
      heard.poses.take(message);
      if (message.type == vrpn::kText)
        if (const auto text = vrpn::decode_text(message.payload); text && text->severity > 0)
          std::fprintf(stderr, "%s: %s\n", c.remote.c_str(), shown(text->text).c_str());
    });
    if (was_connected && !client.connected())
      return client.last_loss().empty() ? "the server left" : fmt::format("the server left ({})", client.last_loss());
    was_connected = was_connected || client.connected();
    if (!was_connected && watch.seconds() > c.patience)
      fail(ErrorKind::io, "{}: no VRPN server answered within {} s{}; start it, or check host and port", c.remote,
           c.patience, client.last_loss().empty() ? "" : " (" + client.last_loss() + ")");
  }
  return was_interrupted() ? "interrupted" : fmt::format("{} s are over", c.duration);
}

std::string poses_of(const wii::Recording& recording, const std::string& tracker_name) {
  const std::unique_ptr<wii::Tracker> tracker = wii::make_tracker(tracker_name, recording.settings);
  std::string text = kPoseHeader;
  for (std::size_t i = 0; i < recording.t.size(); ++i)
    text += pose_row(recording.t[i], tracker->update(recording.t[i], recording.channels[i]));
  return text;
}

std::string poses_of(const HeardPoses& poses) {
  std::string text = kPoseHeader;
  for (const wii::Report& r : poses.reports()) text += pose_row(r.t, r);
  return text;
}

/// Error(input) if what came is not what was asked for.
void check_heard(const ListenCommand& c, const Heard& heard) {
  if (heard.reports() == 0)
    fail(ErrorKind::input, "{}: no report with {} channels came, nor a pose{}; is it the analog device, or a tracker?",
         c.remote, wii::kChannelsMin,
         heard.count_left_out() > 0 ? fmt::format(" (left out {})", heard.left_out()) : "");
  if (heard.channels.trace().rows() > 0 && !heard.poses.reports().empty())
    std::fprintf(stderr, "note: %s: sends poses beside the channels; %zu of them are left out\n", c.remote.c_str(),
                 heard.poses.reports().size());
  if (heard.channels.trace().rows() == 0 && !c.out.path.empty())
    fail(ErrorKind::input, "{}: sends poses and no channels; write them with --poses alone", c.remote);
  if (heard.channels.trace().rows() == 0 && !c.of_channels.empty())
    std::fprintf(stderr, "note: %s: sends poses; not used: %s\n", c.remote.c_str(),
                 fmt::format("{}", fmt::join(c.of_channels, ", ")).c_str());
}

int listen(const ListenCommand& c) {
  if (c.out.path.empty() && c.poses.empty())
    fail(ErrorKind::usage, "wii listen: nothing to write; give -o TRACE, --poses CSV, or both");
  if (c.out.path == c.poses)
    fail(ErrorKind::usage, "wii listen: -o and --poses both name {}; give each a file of its own", c.poses);
  Heard heard(c);
  wii::TrackerSettings settings =
      wii_settings_of(c.remote, heard.channels.trace());  // doubts --leds and --fov before listening
  if (!c.poses.empty()) (void)wii::make_tracker(c.tracker, settings);
  const std::string out = c.out.path.empty() ? "" : check_output({c.out.path, OutputKind::trace, c.out.force, {}});
  if (!c.poses.empty()) (void)check_output({c.poses, OutputKind::text, c.out.force, kPoseHeader});
  vrpn::Client client(vrpn::parse_remote_name(c.remote), !c.no_udp);
  const InterruptScope until_it_is_written;
  const std::string ended = listen_to(client, c, heard);

  if (heard.reports() == 0 && was_interrupted()) return interrupted_exit_code();
  check_heard(c, heard);
  const Trace& trace = heard.channels.trace();
  if (!out.empty()) write_trace(out, trace);
  if (!c.poses.empty())
    write_text(c.poses,
               trace.rows() > 0 ? poses_of(wii_recording_of(c.remote, trace), c.tracker) : poses_of(heard.poses),
               c.out.force);
  if (c.json) {
    const Json j = {{"reports", heard.reports()},
                    {"left_out", heard.count_left_out()},
                    {"left_out_because", heard.left_out()},
                    {"ended", ended},
                    {"interrupted", was_interrupted()}};
    std::printf("%s\n", json_text(j).c_str());
  } else {
    std::printf("took %zu %s; ended: %s\n", heard.reports(), trace.rows() > 0 ? "reports" : "poses", ended.c_str());
    if (heard.count_left_out() > 0) std::printf("left out %s\n", heard.left_out().c_str());
  }
  return was_interrupted() ? interrupted_exit_code() : 0;
}

}  // namespace

void add_wii_listen(CLI::App& wii_command, int& exit_code) {
  auto* command =
      wii_command.add_subcommand("listen", "Takes channels or poses from a VRPN server: a trace, poses, or both");
  auto o = std::make_shared<ListenCommand>();
  command
      ->add_option("DEVICE", o->remote,
                   "WiiMote0@HOST, WiiMote0@HOST:PORT, WiiMote0@tcp://HOST:PORT, or a tracker likewise")
      ->required();
  add_out_options(*command, o->out, "Wii trace to write, .csv or .h5; only a trace is replaced");
  command->add_option(
      "--poses", o->poses,
      "CSV of poses, as wii track writes it: a tracker's of --tracker from channels, or those that come");
  command->add_option("--tracker", o->tracker, "Which tracker")->check(CLI::IsMember(trackers_of(1)));
  command->add_option("--leds", o->leds, "LEDs of the glasses, as in a trace: 'x y z; x y z'");
  command->add_option("--fov", o->fov, "Field of view of that remote, degrees")->expected(2);
  command->add_option("--rate", o->rate, "Nominal rate to write into the trace, 1/s")->check(CLI::PositiveNumber);
  command->add_option("--duration", o->duration, "Stop after this many seconds")->check(seconds());
  command->add_option("--patience", o->patience, "Give up if no server answers for so many seconds")->check(seconds());
  command->add_flag("--no-udp", o->no_udp, "Have reports sent by TCP");
  command->add_flag("--json", o->json, "One JSON object on stdout at the end");
  command->footer("Example: verisim wii listen WiiMote0@localhost -o head.csv --duration 30");
  command->callback([=, &exit_code] {
    for (const char* name : {"--tracker", "--leds", "--fov", "--rate"})
      if (command->count(name) > 0) o->of_channels.emplace_back(name);
    exit_code = listen(*o);
  });
}

}  // namespace verisim::cli
