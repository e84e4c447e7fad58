// The gate before a report is valid.
#include "engine/wii/admission.hpp"

#include <gtest/gtest.h>

namespace verisim::wii::admission_test {
namespace {

using Verdict = Admission::Verdict;

TEST(Admission, RefusesWhatIsTooNearOrTooFar) {
  Admission admission;
  Vector3d near{0, 0, 0.19};
  Vector3d far{0, 0, 5.01};
  EXPECT_EQ(admission.judge(0, 1e-4, near), Verdict::refused);
  EXPECT_EQ(admission.judge(0.01, 1e-4, far), Verdict::refused);
}

TEST(Admission, FirstPlaceIsElsewhereAndTheNextContinues) {
  Admission admission;
  Vector3d p{0, 0, 1};
  EXPECT_EQ(admission.judge(0, 1e-4, p), Verdict::elsewhere);
  EXPECT_EQ(admission.judge(0.01, 1e-4, p), Verdict::continued);
}

TEST(Admission, DrawsNoiseBackToTheGreatestSpeed) {
  Admission admission;
  Vector3d p{0, 0, 3};
  (void)admission.judge(0, 2.5e-3, p);
  p = {0, 0, 3.1};
  EXPECT_EQ(admission.judge(0.01, 2.5e-3, p), Verdict::continued);
  EXPECT_LE(p.z(), 3.05);
  EXPECT_GT(p.z(), 3.049);
}

TEST(Admission, BelievesAJumpTheSecondTime) {
  Admission admission;
  Vector3d p{0, 0, 1};
  (void)admission.judge(0, 1e-4, p);
  p = {0, 0, 2};
  EXPECT_EQ(admission.judge(0.01, 1e-4, p), Verdict::refused);
  p = {0, 0.01, 2};
  EXPECT_EQ(admission.judge(0.02, 1e-4, p), Verdict::elsewhere);
}

TEST(Admission, AfterSilenceAnyPlaceIsNew) {
  Admission admission;
  Vector3d p{0, 0, 1};
  (void)admission.judge(0, 1e-4, p);
  p = {0, 0, 3};
  EXPECT_EQ(admission.judge(0.6, 1e-4, p), Verdict::elsewhere);
}

}  // namespace
}  // namespace verisim::wii::admission_test
