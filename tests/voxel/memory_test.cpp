// What voxelization allocates, counted at operator new.
#include <gtest/gtest.h>
#include <malloc.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "engine/base/error.hpp"
#include "engine/voxel/limits.hpp"
#include "engine/voxel/voxelize.hpp"
#include "tests/voxel/shapes.hpp"

namespace {

std::atomic<std::size_t> bytes_now{0}, bytes_peak{0};

void* counted(void* memory) {
  if (memory == nullptr) throw std::bad_alloc();
  const std::size_t now = bytes_now += malloc_usable_size(memory);
  if (now > bytes_peak) bytes_peak = now;
  return memory;
}

void uncounted(void* memory) {
  bytes_now -= malloc_usable_size(memory);
  std::free(memory);
}

}  // namespace

void* operator new(std::size_t size) {
  return counted(std::malloc(size));
}
void* operator new(std::size_t size, std::align_val_t align) {
  return counted(std::aligned_alloc(static_cast<std::size_t>(align), size));
}
void operator delete(void* memory) noexcept {
  uncounted(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  uncounted(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
  uncounted(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  uncounted(memory);
}

namespace verisim::memory_test {
namespace {

struct Measured {
  VoxelBody body;
  std::size_t kept, peak;  // bytes
};

Measured measure(const TriangleMesh& mesh, const VoxelizeOptions& options) {
  const std::size_t before = bytes_now;
  bytes_peak = before;
  Measured result{voxelize("part", mesh, options), 0, 0};
  result.kept = bytes_now - before;
  result.peak = bytes_peak - before;
  return result;
}

// The engine's own columns and everything in between; fixed-size Eigen types allocate nothing.
TEST(VoxelMemory, OfTheTrialBlockAtHalfAMillimetreIsBelow150MB) {
  const Measured block = measure(shapes::trial_block(), {.voxel_size = 0.0005});
  EXPECT_GT(block.body.voxmap.surface_count, 2'500'000U);
  EXPECT_LT(block.peak, 150'000'000U);
  RecordProperty("peak_bytes", static_cast<int>(block.peak));
}

TEST(VoxelMemory, IsWhatMemoryBytesSays) {
  for (const double spacing : {0.0, 0.01}) {
    const Measured block = measure(shapes::trial_block(), {.voxel_size = 0.002, .point_spacing = spacing});
    const auto kept = static_cast<double>(block.kept);
    const auto said = static_cast<double>(block.body.voxmap.memory_bytes() + block.body.shell.memory_bytes());
    EXPECT_NEAR(said, kept, 0.01 * kept);
  }
}

// Area, not volume: half the voxel size takes four times the memory, not eight; a little less because edges and borders
// weigh less. Tilted, so that it does not matter how faces happen to fall among bricks.
TEST(VoxelMemory, FollowsSurfaceArea) {
  const Eigen::AngleAxisd tilt(0.5, Vector3d(1, 2, 3).normalized());
  const TriangleMesh mesh = shapes::mapped(shapes::trial_block(), [&](const Vector3d& p) { return tilt * p; });
  const auto kept = [&](double size) { return static_cast<double>(measure(mesh, {.voxel_size = size}).kept); };
  const double coarse = kept(0.002), fine = kept(0.001);
  EXPECT_NEAR(fine / coarse, 4, 0.2);
}

TEST(MemoryEstimate, IsNearTheTruth) {
  for (const double size : {0.004, 0.002, 0.001}) {
    for (const TriangleMesh& mesh : {shapes::trial_block(), shapes::sphere(0.2, 5)}) {
      const VoxelBody body = voxelize("part", mesh, {.voxel_size = size});
      const auto truth = static_cast<double>(body.voxmap.memory_bytes() + body.shell.memory_bytes());
      EXPECT_NEAR(MemoryEstimate(mesh, checked_bounds("part", mesh)).bytes(size), truth, 0.3 * truth) << size;
    }
  }
}

TEST(VoxelMemory, IsRefusedBeforeItIsAllocatedWithASizeThatFits) {
  const TriangleMesh mesh = shapes::trial_block();
  for (const double size : {1e-5, 1e-9, 1e-300}) {
    const std::size_t before = bytes_now;
    bytes_peak = before;
    try {
      (void)voxelize("block", mesh, {.voxel_size = size, .memory_limit = 100'000'000});
      FAIL() << "accepted " << size;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
      const std::string text = error.what();
      EXPECT_EQ(text.find("block: voxelsize"), 0U) << text;
      const std::size_t at = text.find("are allowed; ");
      ASSERT_NE(at, std::string::npos) << text;
      const double fits = std::stod(text.substr(at + 13));
      EXPECT_NO_THROW((void)voxelize("block", mesh, {.voxel_size = fits, .memory_limit = 100'000'000})) << text;
      EXPECT_GT(fits, 0.0004) << text;
      EXPECT_LT(fits, 0.001) << text;
    }
    EXPECT_LT(bytes_peak - before, 120'000'000U);  // the second, accepted voxelization's
  }
}

}  // namespace
}  // namespace verisim::memory_test
