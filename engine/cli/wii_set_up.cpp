#include "engine/cli/wii_set_up.hpp"

#include <filesystem>

#include "engine/base/error.hpp"
#include "engine/record/trace.hpp"
#include "engine/script/wii_recording.hpp"
#include "engine/simulation/inputs.hpp"

namespace verisim::cli {

void refuse_virtual_remote(const CLI::App& command, bool seed_too, const std::string& because) {
  for (const CLI::Option* option : command.get_options())
    if (option->count() > 0 && (option->get_group() == kVirtualRemote || (seed_too && option->check_name("--seed"))))
      fail(ErrorKind::usage, "{}: describes a virtual remote, but {}; leave one of them out", option->get_name(),
           because);
}

void SetUpOptions::add(CLI::App& command) {
  command.add_option("--leds", leds, "LEDs of the glasses, m, as in a trace: 'x y z; x y z'")->group(kVirtualRemote);
  command.add_option("--fov", fov, "Field of view of the remote, degrees")
      ->expected(2)
      ->check(CLI::Range(1.0, 170.0))
      ->group(kVirtualRemote);
  command.add_option("--remote-pose", remote_pose, "Where the remote stands: px py pz qx qy qz qw, m, +y up")
      ->expected(7)
      ->group(kVirtualRemote);
  const auto number = [&](const char* name, std::optional<double>& value, double max, const char* what) {
    command.add_option(name, value, what)->check(CLI::Range(0.0, max))->group(kVirtualRemote);
  };
  number("--pixel-noise", rest.pixel_noise, 100, "Noise of a blob's place, pixel rms");
  number("--accelerometer-noise", rest.accelerometer_noise, 1, "Noise of the accelerometer, g rms");
  command.add_option("--accelerometer-bits", rest.accelerometer_bits, "0: exact, 8: steps of 0.04 g, 10: of 0.01 g")
      ->check(CLI::IsMember({0, 8, 10}))
      ->group(kVirtualRemote);
  command.add_option("--rate", rest.rate, "Reports of the remote, 1/s")
      ->check(CLI::Range(1.0, 1e4))
      ->group(kVirtualRemote);
  number("--latency", rest.latency, 1, "By which a report's time trails what it shows, s");
}

wii::SetUp SetUpOptions::set_up() const {
  std::map<std::string, std::string> header;
  if (!leds.empty()) header["leds"] = leds;
  if (!fov.empty()) header["fov_deg"] = fmt::format("{} {}", fov[0], fov[1]);
  if (!remote_pose.empty()) header["remote_pose"] = fmt::format("{}", fmt::join(remote_pose, " "));
  return wii::first_of(wii_set_up_of("command line", header), rest);
}

wii::Trajectory read_motion(const std::string& file, std::vector<FileIdentity>& opened) {
  Inputs inputs = Inputs::live(".", {file});
  const Trace trace = parse_trace(file, inputs.read(file), "", {.allow_gaps = true});
  opened.insert(opened.end(), inputs.opened().begin(), inputs.opened().end());
  std::vector<Pose> X_LH = trace_poses(trace);
  if (X_LH.empty()) fail(ErrorKind::input, "{}: no columns px ... qw; a motion is a trace with poses", file);
  std::vector<double> t;
  for (std::size_t row = 0; row < trace.rows(); ++row) t.push_back(trace.at(row, 0));
  wii::Trajectory path =
      wii::recorded_trajectory(std::filesystem::path(file).stem().string(), std::move(t), std::move(X_LH));
  path.own = wii_set_up_of(file, trace.extra);
  return path;
}

}  // namespace verisim::cli
