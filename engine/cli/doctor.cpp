#include <sys/utsname.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <thread>

#include "engine/base/json.hpp"
#include "engine/cli/commands.hpp"
#include "engine/contact/query.hpp"
#include "engine/geometry/loader.hpp"
#include "engine/session/origin.hpp"
#include "engine/session/prepared_parts.hpp"
#include "engine/session/realtime_priority.hpp"

namespace verisim::cli {
namespace {

/// The shortest time between two different readings of the clock [ns].
std::int64_t clock_step_ns() {
  std::int64_t best = std::int64_t{1} << 60;
  for (int i = 0; i < 1000; ++i) {
    const auto a = std::chrono::steady_clock::now();
    auto b = a;
    while (b == a) b = std::chrono::steady_clock::now();
    best = std::min<std::int64_t>(best, (b - a) / std::chrono::nanoseconds(1));
  }
  return best;
}

/// How late a 1 ms sleep ends, worst of 200 [ns].
std::int64_t sleep_lateness_ns() {
  std::int64_t worst = 0;
  for (int i = 0; i < 200; ++i) {
    const auto due = std::chrono::steady_clock::now() + std::chrono::milliseconds(1);
    std::this_thread::sleep_until(due);
    worst = std::max<std::int64_t>(worst, (std::chrono::steady_clock::now() - due) / std::chrono::nanoseconds(1));
  }
  return worst;
}

/// Empty if the CAD kernel's program starts and answers; else the reason why not.
std::string cad_trouble() {
  try {
    Solid box;
    box.kind = Solid::Kind::box;
    box.sizes = {0.01, 0.01, 0.01};
    (void)load_solid(box, {});
    return {};
  } catch (const std::exception& error) {
    return error.what();
  }
}

/// "FOLDER: 12 entries, 3.4 MB".
std::string prepared_text() {
  const std::string folder = prepared_folder();
  if (folder.empty()) return "none: there is no HOME; name a folder in VERISIM_CACHE";
  const PreparedStore::Size size = PreparedStore::size_of(folder);
  return fmt::format("{}: {} entries, {:.1f} MB", folder, size.entries, static_cast<double>(size.bytes) / 1e6);
}

Json examine() {
  Json j;
  j["version"] = VERISIM_VERSION;
  j["commit"] = commit();
  j["compiler"] = compiler();
  j["cpu"] = cpu_model();
  j["cores"] = std::thread::hardware_concurrency();
  utsname system{};
  uname(&system);
  j["kernel"] = std::string(system.sysname) + " " + system.release;
  j["simd"] = simd_targets();
  j["realtime_priority"] = RealtimePriority(true).granted() ? "granted" : "refused: CAP_SYS_NICE, or `ulimit -r 1`";
  j["clock_step_ns"] = clock_step_ns();
  j["sleep_1ms_late_by_at_most_ns"] = sleep_lateness_ns();
  const std::string trouble = cad_trouble();
  j["prepared_parts"] = prepared_text();
  j["cad_kernel"] = trouble.empty() ? "answers" : trouble;
  return j;
}

}  // namespace

void add_doctor(CLI::App& app, int& exit_code) {
  auto* command =
      app.add_subcommand("doctor", "CPU features, clocks, optional parts: what is there and what is missing");
  auto as_json = std::make_shared<bool>(false);
  command->add_flag("--json", *as_json, "One JSON object on stdout");
  command->footer("Example: verisim doctor");
  command->callback([=, &exit_code] {
    const Json report = examine();
    if (*as_json)
      std::printf("%s\n", json_text(report).c_str());
    else
      for (const auto& [name, value] : report.items())
        std::printf("%-30s%s\n", name.c_str(),
                    (value.is_string() ? value.get<std::string>() : json_text(value)).c_str());
    exit_code = 0;
  });
}

}  // namespace verisim::cli
