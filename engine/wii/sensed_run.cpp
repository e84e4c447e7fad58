#include "engine/wii/sensed_run.hpp"

#include <algorithm>
#include <array>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"

namespace verisim::wii {
namespace {

constexpr double kSecondRemoteSide = 0.5;  // m

}  // namespace

Pose second_remote() {
  return {{kSecondRemoteSide, 0, 0}, rotation_from_vector({0, -pinned::atan2(kSecondRemoteSide, 1.2), 0})};
}

std::vector<Sensed> sense_run(const RemoteSettings& settings, const Trajectory& path, int remotes, std::uint64_t seed,
                              double latency) {
  VERISIM_ASSERT(remotes == 1 || remotes == 2);
  VERISIM_ASSERT(is_not_negative(latency));
  std::array<VirtualRemote, 2> watching = {VirtualRemote(settings, seed, path.name + "/first"),
                                           VirtualRemote(settings, seed, path.name + "/second")};
  std::vector<Sensed> all;
  const auto count = static_cast<std::uint64_t>(path.duration * settings.rate);
  for (std::uint64_t k = 0; k < count; ++k)
    for (int i = remotes - 1; i >= 0; --i) {
      VirtualRemote& remote = watching[static_cast<std::size_t>(i)];
      const double t = remote.report_time(k);
      const auto at = [&](double when) {
        Situation s = path.at(std::max(0.0, when));
        if (i == 1) s.X_WR = s.X_WR * second_remote();
        return s;
      };
      SensedReport report = remote.sense(k, at(t - latency));
      if (latency > 0) report.X_LH = levelled_pose(at(t));
      if (!remote.lost(k)) all.push_back({report, i});
    }
  std::stable_sort(all.begin(), all.end(), [](const Sensed& a, const Sensed& b) { return a.report.t < b.report.t; });
  return all;
}

}  // namespace verisim::wii
