// Functions common to the wii commands.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "engine/base/user_file.hpp"
#include "engine/record/trace.hpp"
#include "engine/wii/report_source.hpp"

namespace verisim::cli {

void add_wii_validate(CLI::App& wii_command, int& exit_code);
void add_wii_judge(CLI::App& wii_command, int& exit_code);
void add_wii_track(CLI::App& wii_command, int& exit_code);
void add_wii_serve(CLI::App& wii_command, int& exit_code);
void add_wii_listen(CLI::App& wii_command, int& exit_code);

/// A wii trace that the command line names. Error(input). Adds to `opened` which file it is.
[[nodiscard]] wii::Recording read_wii_file(const std::string& file, const TraceLimits& limits,
                                           std::vector<FileIdentity>* opened = nullptr);
/// The trackers that need `remotes` remotes: as many traces.
[[nodiscard]] std::vector<std::string> trackers_of(int remotes);

/// Of a table of trajectories or sensors.
template <typename Named>
[[nodiscard]] std::vector<std::string> names_of(const std::vector<Named>& all) {
  std::vector<std::string> names;
  for (const Named& n : all) names.push_back(n.name);
  return names;
}

/// The columns of a CSV of poses (INTERFACES section 1), and one row of it, numbers as short as reads back to the bit.
inline constexpr const char* kPoseHeader = "t,valid,px,py,pz,qx,qy,qz,qw,cpx,cpy,cpz,crx,cry,crz\n";
[[nodiscard]] std::string pose_row(double t, const wii::Report& report);
/// With --full: the same, then `news,reacquired,c00,c01 … c55`, the whole covariance row by row.
[[nodiscard]] std::string full_pose_header();
[[nodiscard]] std::string full_pose_row(double t, const wii::Report& report);

}  // namespace verisim::cli
