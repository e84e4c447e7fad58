// INTERFACES section 2: same input, same bits, whatever the threads and the vector width; and the golden hashes, which
// change only in a commit that says which behaviour changed and why.
#include <gtest/gtest.h>

#include <map>

#include "engine/base/hash.hpp"
#include "engine/contact/query.hpp"
#include "tests/determinism/core_scenes.hpp"
#include "tests/length.hpp"

namespace verisim::determinism::same_bits_test {
namespace {

/// Restores free dispatch when a test ends.
struct AnySimdTarget {
  ~AnySimdTarget() { use_simd_target(""); }
};

TEST(SameBits, OnEverySimdTargetAndNumberOfThreads) {
  const AnySimdTarget restore;
  for (const CoreScene& scene : core_scenes()) {
    use_simd_target("scalar");
    const CoreResult plain = run_core(scene, 1);
    ASSERT_GT(plain.contacts, 0U) << scene.name << ": nothing ever touched: this test would prove nothing";
    for (const std::string& target : simd_targets()) {
      use_simd_target(target);
      for (const unsigned threads : test::some_of({2U, 1U}))
        EXPECT_EQ(run_core(scene, threads), plain)
            << scene.name << " on " << target << " with " << threads << " threads";
    }
  }
}

struct Golden {
  const char* hash;
  std::uint64_t collision_frames;  ///< a physical fact beside the bits: it survives harmless changes
  std::uint64_t constrained_frames = 0;
};

const std::map<std::string, Golden> kGolden = {
    {"pin_in_hole", {"ce6de44c95101186", 738}},        {"pin_in_hole_implicit", {"e6aafab26ce05df8", 737}},
    {"pin_restored", {"e57107ae6692dc73", 736, 736}},  {"pin_restored_implicit", {"a15dd743113dc650", 734, 734}},
    {"pin_blended", {"bb6e5d426e6739c8", 1045, 1045}}, {"pin_exact", {"689fb81d11e95d7f", 283}},
    {"cone_exact", {"f80ab4a892bbfc24", 91}},          {"two_pins_exact", {"d664a3d62eb5bac3", 247}},
    {"falling_boxes", {"f26248a99fe29f1a", 440}},      {"falling_boxes_implicit", {"4764cb4380e04389", 440}},
};

TEST(SameBits, AsWhenTheGoldenHashesWereWritten) {
  for (const CoreScene& scene : core_scenes()) {
    const CoreResult result = run_core(scene, 1);
    EXPECT_EQ(to_hex(result.hash), kGolden.at(scene.name).hash) << scene.name;
    EXPECT_EQ(result.collision_frames, kGolden.at(scene.name).collision_frames) << scene.name;
    EXPECT_EQ(result.constrained_frames, kGolden.at(scene.name).constrained_frames) << scene.name;
  }
}

// The alarm itself: one bit of the input changes the hash.
TEST(SameBits, OneBitOfTheInputIsSeen) {
  CoreScene scene = core_scenes().front();
  const CoreResult before = run_core(scene, 1);
  const auto make = scene.make;
  scene.make = [make] {
    Scene changed = make();
    changed.bodies[1].density = std::nextafter(changed.bodies[1].density, 1e9);
    return changed;
  };
  EXPECT_NE(run_core(scene, 1).hash, before.hash);
}

}  // namespace
}  // namespace verisim::determinism::same_bits_test
