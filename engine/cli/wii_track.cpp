#include <memory>

#include "engine/base/error.hpp"
#include "engine/cli/options.hpp"
#include "engine/cli/wii_commands.hpp"
#include "engine/record/output_place.hpp"
#include "engine/script/wii_recording.hpp"

namespace verisim::cli {

wii::Recording read_wii_file(const std::string& file, const TraceLimits& limits, std::vector<FileIdentity>* opened) {
  Inputs inputs = Inputs::live(".", {file});
  wii::Recording recording = read_wii_recording(inputs, file, limits);
  if (opened != nullptr) opened->insert(opened->end(), inputs.opened().begin(), inputs.opened().end());
  return recording;
}

std::vector<std::string> trackers_of(int remotes) {
  std::vector<std::string> names;
  for (const wii::TrackerEntry& entry : wii::trackers())
    if (entry.remotes == remotes) names.emplace_back(entry.name);
  return names;
}

std::string pose_row(double t, const wii::Report& report) {
  const Vector3d& p = report.pose.position;
  const auto& q = report.pose.rotation.coeffs();
  const auto v = report.covariance.diagonal();
  return fmt::format("{},{:d},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", t, report.valid, p.x(), p.y(), p.z(), q[0],
                     q[1], q[2], q[3], v[0], v[1], v[2], v[3], v[4], v[5]);
}

std::string full_pose_header() {
  std::string text = kPoseHeader;
  text.back() = ',';
  text += "news,reacquired";
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) text += fmt::format(",c{}{}", i, j);
  return text + "\n";
}

std::string full_pose_row(double t, const wii::Report& report) {
  std::string text = pose_row(t, report);
  text.back() = ',';
  text += fmt::format("{:d},{:d}", report.news, report.reacquired);
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) text += fmt::format(",{}", report.covariance(i, j));
  return text + "\n";
}

namespace {

std::string track(const wii::Recording& first, const wii::Recording* second, const std::string& name, bool full) {
  wii::TrackerSettings settings = first.settings;
  if (second != nullptr) settings.X_R1R2 = first.X_WR.inverse() * second->X_WR;
  const std::unique_ptr<wii::Tracker> tracker = wii::make_tracker(name, settings);
  std::string text = full ? full_pose_header() : kPoseHeader;
  std::size_t other = 0;
  for (std::size_t i = 0; i < first.t.size(); ++i) {
    for (; second != nullptr && other < second->t.size() && second->t[other] <= first.t[i]; ++other)
      (void)tracker->update(second->t[other], second->channels[other], 1);
    const wii::Report& report = tracker->update(first.t[i], first.channels[i]);
    text += full ? full_pose_row(first.t[i], report) : pose_row(first.t[i], report);
  }
  return text;
}

}  // namespace

void add_wii_track(CLI::App& wii_command, int& exit_code) {
  struct Options {
    std::string trace, second, tracker = "geometric";
    OutOptions out;
    bool full = false;
    TraceLimits limits;
  };
  auto* command =
      wii_command.add_subcommand("track", "One tracker over one trace (or two): a CSV with a row per sample");
  auto o = std::make_shared<Options>();
  command->add_option("TRACE", o->trace, "Wii trace, CSV or HDF5")->required();
  const std::string of_two = fmt::format("{}", fmt::join(trackers_of(2), " or "));
  command->add_option("--second", o->second,
                      fmt::format("Trace of the second remote, for {}; both say '# remote_pose:'", of_two));
  command->add_option("--tracker", o->tracker, "Which")->check(CLI::IsMember(wii::tracker_names()));
  add_out_options(*command, o->out, "CSV to write; only a CSV of poses is replaced")->required();
  command->add_flag("--full", o->full, "Append news, reacquired and the whole covariance, c00 … c55 row by row");
  command->add_flag("--allow-gaps", o->limits.allow_gaps, "Accept gaps longer than 0.1 s");
  command->add_flag("--resort", o->limits.resort, "Sort the samples by time first");
  command->footer("Example: verisim wii track head.csv --tracker scaat -o pose.csv");
  command->callback([=, &exit_code] {
    const bool needs_second = wii::find_tracker(o->tracker).remotes == 2;
    if (o->second.empty() == needs_second)
      fail(ErrorKind::usage, "wii track: --second and --tracker {} belong together; {}", of_two,
           needs_second ? "name the second remote's trace" : "choose --tracker " + of_two);
    std::vector<FileIdentity> inputs;
    const wii::Recording first = read_wii_file(o->trace, o->limits, &inputs);
    wii::Recording second;
    if (!o->second.empty()) {
      second = read_wii_file(o->second, o->limits, &inputs);
      if (!second.placed)
        fail(ErrorKind::input, "{}: no '# remote_pose:'; {} must know where the second remote is", o->second,
             o->tracker);
    }
    // Before the work. A short table and a full one begin alike.
    std::string beginning = kPoseHeader;
    beginning.pop_back();
    (void)check_output({o->out.path, OutputKind::text, o->out.force, beginning}, inputs);
    write_text(o->out.path, track(first, o->second.empty() ? nullptr : &second, o->tracker, o->full), o->out.force,
               inputs);
    exit_code = 0;
  });
}

}  // namespace verisim::cli
