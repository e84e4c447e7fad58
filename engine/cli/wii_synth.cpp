#include "engine/cli/wii_synth.hpp"

#include "engine/base/error.hpp"
#include "engine/cli/wii_commands.hpp"
#include "engine/script/wii_recording.hpp"
#include "engine/wii/validate.hpp"

namespace verisim::cli {
void VirtualRunOptions::add(CLI::App& command) {
  command.add_option("--trajectory", trajectory, "Of the head, as wii validate lists them (default: natural)")
      ->check(CLI::IsMember(names_of(wii::trajectories())))
      ->group(kVirtualRemote);
  command.add_option("--motion", motion, "Recorded motion of a head instead: a trace with poses, levelled coordinates")
      ->group(kVirtualRemote);
  command.add_option("--sensor", sensor, "What the remote is like, as wii validate lists them (default: wiimote)")
      ->check(CLI::IsMember(names_of(wii::sensor_cases())))
      ->group(kVirtualRemote);
  set_up.add(command);
}

VirtualRun run_virtually(const VirtualRunOptions& o, std::vector<FileIdentity>& opened) {
  const wii::Trajectory path = o.motion.empty() ? wii::trajectory(o.trajectory) : read_motion(o.motion, opened);
  const wii::SensorCase& sensor = wii::sensor_case(o.sensor);
  VirtualRun run;
  run.trajectory = path.name;
  run.sensor = sensor.name;
  run.set_up = wii::first_of(o.set_up.set_up(), path.own);
  run.settings.leds = run.set_up.leds.value_or(wii::LedLayout());
  const wii::RemoteSettings remote = wii::remote_settings(sensor.settings, path, run.settings.leds, run.set_up);
  run.settings.fov = remote.fov;
  run.rate = remote.rate;
  const wii::Trajectory there = wii::placed(path, run.set_up);
  if (!path.moves_remote) run.set_up.X_WR = there.at(0).X_WR;
  for (const wii::Sensed& s : wii::sense_run(remote, there, 1, o.seed, run.set_up.latency.value_or(0)))
    run.samples.push_back(s.report);
  return run;
}

Trace wii_trace_of(const VirtualRun& run, const std::string& source) {
  Trace trace;
  trace.kind = "wii";
  trace.rate_hz = run.rate;
  trace.source = source;
  wii::SetUp set_up = run.set_up;
  set_up.leds = run.settings.leds;
  set_up.fov = run.settings.fov;
  trace.extra = wii_header_of(set_up);
  trace.columns = wii_trace_columns();
  for (const char* name : {"px", "py", "pz", "qx", "qy", "qz", "qw"}) trace.columns.emplace_back(name);
  for (const wii::SensedReport& s : run.samples) {
    trace.values.push_back(s.t);
    trace.values.insert(trace.values.end(), s.channels.begin(), s.channels.end());
    const Vector3d& p = s.X_LH.position;
    const auto& q = s.X_LH.rotation.coeffs();
    trace.values.insert(trace.values.end(), {p.x(), p.y(), p.z(), q[0], q[1], q[2], q[3]});
  }
  return trace;
}

}  // namespace verisim::cli
