#include "engine/stability/law.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

#include "engine/base/error.hpp"
#include "engine/geometry/loader.hpp"

namespace verisim::stability {

Said run(const std::function<Scene()>& make, std::uint64_t frames, const std::function<void(Simulation&)>& look) {
  static constexpr std::array<std::string_view, 8> kAmiss = {"energy",   "tunnelling", "sinking",  "overlap",
                                                             "rounding", "spin",       "left out", "diverged"};
  Said said;
  std::vector<std::string> told;
  try {
    Simulation simulation(make(), {});
    while (simulation.frame() < frames) {
      simulation.step();
      for (const Event& event : simulation.events())
        if (std::find(kAmiss.begin(), kAmiss.end(), event.kind) != kAmiss.end() &&
            std::find(told.begin(), told.end(), event.kind) == told.end()) {
          told.push_back(event.kind);
          said.events += (said.events.empty() ? "" : "; ") + event.kind + ": " + event.text;
        }
      simulation.clear_events();
      look(simulation);
    }
  } catch (const Error& error) {
    (error.kind() == ErrorKind::diverged ? said.diverged : said.refused) = true;
    said.events += (said.events.empty() ? "" : "; ") + std::string(error.what());
  }
  return said;
}

void conclude(Row& row, const Said& said, bool laws, bool bounded, bool restless) {
  row.holds = laws && !said.refused && !said.diverged;
  row.why = said.events;
  row.outcome = said.refused                ? Outcome::refused
                : said.diverged || !bounded ? Outcome::diverged
                : restless                  ? Outcome::limit_cycle
                                            : Outcome::stable;
}

BodyDescription solid_body(const std::string& name, const Solid& solid, double mass, double voxel_size) {
  BodyDescription body;
  body.name = name;
  body.parts.push_back(load_solid(solid, {}));
  body.density = mass / body.parts[0].mass.volume;
  body.voxel_size = voxel_size;
  return body;
}

namespace {
std::shared_ptr<const Solid> primitive(Solid::Kind kind, std::vector<double> sizes) {
  return std::make_shared<Solid>(Solid{.kind = kind, .sizes = std::move(sizes), .children = {}, .placement = {}});
}
}  // namespace

std::shared_ptr<const Solid> box_solid(const Vector3d& size) {
  return primitive(Solid::Kind::box, {size.x(), size.y(), size.z()});
}
std::shared_ptr<const Solid> cylinder_solid(double radius, double height) {
  return primitive(Solid::Kind::cylinder, {radius, height});
}
Solid difference(std::shared_ptr<const Solid> a, std::shared_ptr<const Solid> b) {
  return {.kind = Solid::Kind::difference, .sizes = {}, .children = {std::move(a), std::move(b)}, .placement = {}};
}

}  // namespace verisim::stability
