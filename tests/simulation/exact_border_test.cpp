// Where precise knowledge ends: half of a plate's top is a plane, the other half a surface that is known by its voxels
// only. A box that a hand slides across the border must not feel more than voxels let it feel anyway.
#include <gtest/gtest.h>

#include "tests/simulation/hybrid_scenes.hpp"

namespace verisim::exact_border_test {
namespace {

constexpr double kThick = 0.02, kVoxel = 0.002;
constexpr std::size_t kBox = 1;

std::shared_ptr<const Solid> box_at(double x, double z, std::vector<double> sizes) {
  return std::make_shared<Solid>(Solid{.kind = Solid::Kind::placed,
                                       .sizes = {},
                                       .children = {scenes::solid(Solid::Kind::box, std::move(sizes))},
                                       .placement = {{x, 0, z}, Quaterniond::Identity()}});
}

/// Its top is two faces at one height, with a groove of half a millimetre between them.
Solid plate() {
  return scenes::difference(box_at(0, 0, {0.32, 0.12, kThick}), box_at(0, 0.5 * kThick, {0.0005, 0.2, 0.01}));
}

/// Which half of the top has no surface: none, that of growing x, or the other.
enum class Unknown : std::uint8_t { none, right, left };

/// The plate without its known half. It ends in the groove's middle: in the same voxels as the groove's side.
Solid half_plate(Unknown side) {
  return *box_at(side == Unknown::right ? 0.08 : -0.08, 0, {0.16, 0.12, kThick});
}

/// The box stands before the plate's left half, a millimetre above it.
Scene box_over_plate(Hybrid hybrid, Unknown unknown) {
  Scene scene;
  scene.parameters.hybrid = hybrid;
  scene.parameters.integrator = Integrator::implicit;
  scene.parameters.all_bodies_are_dynamic = true;
  scene.bodies.push_back(scenes::body_of("plate", plate(), kVoxel));
  scene.bodies.push_back(scenes::body_of("box", *scenes::solid(Solid::Kind::box, {0.05, 0.05, 0.04}), kVoxel));
  scene.bodies[0].fixed = true;
  scene.bodies[kBox].density = 500;
  scene.bodies[kBox].X_WB.position = {-0.09, 0, 0.5 * kThick + 0.021};
  Part& part = scene.bodies[0].parts.front();
  int tops = 0;
  for (std::size_t f = 0; f < part.faces.size(); ++f) {
    const auto* plane = std::get_if<Plane>(&part.faces[f].surface);
    if (plane == nullptr || plane->normal.z() < 0.5 || plane->point.z() < 0.4 * kThick) continue;
    ++tops;
    double x = 0;
    for (std::size_t t = 0; t < part.mesh.triangles.size(); ++t)
      if (part.mesh.face_of_triangle[t] == f) x += part.mesh.vertices[part.mesh.triangles[t][0]].x();
    if ((unknown == Unknown::right && x > 0) || (unknown == Unknown::left && x < 0))
      part.faces[f].surface = OtherSurface{};
  }
  EXPECT_EQ(tops, 2) << "the plate's top is to be two faces";
  return scene;
}

constexpr double kSpeed = 0.1;  // m/s

/// A hand presses the box down and slides it to the right.
Scene sliding_box(Hybrid hybrid, Unknown unknown, double speed) {
  Scene scene = box_over_plate(hybrid, unknown);
  const double pressed = 0.5 * kThick + 0.018;
  scene.devices = {
      scenes::hand_along({{-0.09, 0, 0.5 * kThick + 0.021}, {-0.09, 0, pressed}, {0.09, 0, pressed}}, speed)};
  scene.grasps = {{0, kBox}};
  return scene;
}

struct Slide {
  double step_max = 0;    ///< N, change of the contact force from frame to frame
  double height_max = 0;  ///< m, of the box above the plate, either way
};

/// What happens once the box lies on the plate, while its middle is between `from` and `to` [m].
Slide slide(Hybrid hybrid, Unknown unknown, double from, double to, double speed = kSpeed) {
  Simulation simulation(sliding_box(hybrid, unknown, speed), {});
  Slide result;
  Vector3d before = Vector3d::Zero();
  while (simulation.frame() < simulation.frames_planned()) {
    simulation.step();
    const Vector3d force = simulation.body_force(kBox).force;
    const Vector3d p = simulation.body_pose(kBox).position;
    if (simulation.time() > 0.2 && p.x() > from && p.x() < to) {
      result.step_max = std::max(result.step_max, (force - before).norm());
      result.height_max = std::max(result.height_max, std::abs(p.z() - 0.5 * kThick - 0.02));
    }
    before = force;
  }
  return result;
}

// The box's lower edge lies in the plate's plane, but for what 0.3 N press it in: far less than a nanometre. It must
// not stumble over the far side of the groove because of that.
TEST(Groove, IsCrossedByWhatSlidesFlatOverIt) {
  const Slide known = slide(hybrid::exact, Unknown::none, -0.1, 0.1);
  EXPECT_LE(known.height_max, 1e-9);
  EXPECT_LE(known.step_max, 0.3);
}

// Up to the border the precise answer stands as if all were known: quiet, where voxels rattle. Beyond it is the voxels'
// and no worse than theirs; and the way from one to the other is not worse than that either. How hard a box rattles
// over voxels is a draw: 6.7 to 8.1 N for speeds from 0.0925 to 0.1075 m/s, 5.4 to 8.0 N across the border. The means
// of eight of each are compared.
TEST(Border, OfWhatIsKnownIsCrossedWithoutAJump) {
  constexpr double kBefore = -0.026;  // the box's front is a millimetre before the groove
  const Slide before = slide(hybrid::exact, Unknown::right, -0.1, kBefore);
  EXPECT_LE(before.height_max, 1e-9);
  EXPECT_LE(before.step_max, 1e-4);
  Slide voxels, across;  // sums
  const auto add = [](Slide& sum, const Slide& one) {
    sum = {sum.step_max + one.step_max, sum.height_max + one.height_max};
  };
  for (int i = 0; i < 8; ++i) {
    const double speed = 0.0965 + 0.001 * i;
    add(voxels, slide(hybrid::off, Unknown::right, -0.1, 0.1, speed));
    add(across, slide(hybrid::exact, Unknown::right, kBefore, 0.03, speed));
  }
  EXPECT_LE(across.height_max, 1.1 * voxels.height_max);
  EXPECT_LE(across.step_max, 1.1 * voxels.step_max);
}

/// What the plate pushes the box with at one place.
struct Push {
  Vector3d force;  ///< N
  std::uint64_t contacts;
};

/// The box is put into one place after the other along the plate, above the plane by what keeps precise faces apart and
/// lets voxels touch.
std::vector<Push> push_along(const Scene& scene, double height) {
  constexpr int kPlaces = 1600;
  Simulation simulation(scene, {});
  std::vector<Push> result;
  for (int i = 0; i < kPlaces; ++i) {
    simulation.set_body_pose(kBox, {{-0.08 + 0.0001 * i, 0, 0.5 * kThick + 0.02 + height}, Quaterniond::Identity()});
    simulation.step();
    result.push_back({simulation.body_force(kBox).force, simulation.body_contacts(kBox)});
  }
  return result;
}

// Where precise faces are apart and voxels are not, all force comes from what is not known. A box that goes over the
// border must feel at every place what it feels where the known half is not there at all, contact by contact: a contact
// at the border that counts for both, or for neither, or a pair that changes its method at once, is another force
// there.
TEST(Border, OfWhatIsKnownIsTheBorderOfWhatVoxelsAnswer) {
  for (const Unknown side : {Unknown::right, Unknown::left}) {
    for (const double height : {3e-4, 7e-4}) {
      SCOPED_TRACE(::testing::Message() << (side == Unknown::right ? "right " : "left ") << height);
      const std::vector<Push> mixed = push_along(box_over_plate(hybrid::exact, side), height);
      Scene alone = box_over_plate(hybrid::off, side);
      alone.bodies[0] = scenes::body_of("plate", half_plate(side), kVoxel);
      alone.bodies[0].fixed = true;
      const std::vector<Push> half = push_along(alone, height);
      double largest = 0;
      std::size_t untouched = 0;
      for (std::size_t i = 0; i < mixed.size(); ++i) {
        ASSERT_EQ(mixed[i].contacts, half[i].contacts) << "place " << i;
        ASSERT_LE((mixed[i].force - half[i].force).norm(), 1e-5) << "place " << i;
        largest = std::max(largest, mixed[i].force.norm());
        untouched += mixed[i].contacts == 0 ? 1 : 0;
      }
      EXPECT_GT(largest, 5) << "nothing touches: this test would prove nothing";
      EXPECT_GT(untouched, mixed.size() / 4) << "nothing is known: this test would prove nothing";
    }
  }
}

}  // namespace
}  // namespace verisim::exact_border_test
