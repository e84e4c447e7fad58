// STEP files: written by the project and read back, and bad ones.
#include "tests/geometry/models.hpp"
#include "tests/support/folder.hpp"

namespace verisim::step_file_test {
namespace {

using testing::error_of;
using testing::make;
using testing::placed;
using Kind = Solid::Kind;

const Solid kBlock = make(Kind::difference, make(Kind::box, {0.2, 0.2, 0.2}), make(Kind::cylinder, {0.05, 0.4}));
const Solid kPin = placed(make(Kind::cylinder, {0.045, 0.4}), {0, 0, 0.5}, rotation_from_vector({0.1, 0.2, 0}));

class Step : public ::testing::Test {
 protected:
  std::string written(const std::vector<std::pair<std::string, Solid>>& solids) const {
    write_step(path_, solids);
    std::string content = testing::read_file(path_);
    std::filesystem::remove(path_);
    return content;
  }
  test::Folder folder_;
  std::string path_ = folder_.file("written.step");
};

TEST_F(Step, ComesBackAsItWasWritten) {
  const std::vector<Part> parts = load_model("pair.step", written({{"block", kBlock}, {"pin", kPin}}), {});
  ASSERT_EQ(parts.size(), 2U);
  const std::vector<Part> originals = {load_solid(kBlock, {}), load_solid(kPin, {})};
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(testing::face_counts(parts[i]), testing::face_counts(originals[i]));
    EXPECT_EQ(parts[i].edges.size(), originals[i].edges.size());
    EXPECT_NEAR(parts[i].mass.volume, originals[i].mass.volume, 1e-11 * originals[i].mass.volume);
    EXPECT_LE((parts[i].mass.centroid - originals[i].mass.centroid).norm(), 1e-10);
    EXPECT_TRUE(parts[i].watertight);
  }
  EXPECT_EQ(parts[0].name, "block");
  EXPECT_EQ(parts[1].name, "pin");
  const std::vector<Mate> mates = mating_candidates(parts);
  ASSERT_EQ(mates.size(), 1U);
  EXPECT_NEAR(mates[0].clearance(), 0.005, 1e-12);
}

TEST_F(Step, IsTheSameFileWheneverItIsWritten) {
  EXPECT_EQ(written({{"block", kBlock}}), written({{"block", kBlock}}));
}

TEST_F(Step, CutOffAnywhereIsRefused) {
  const std::string whole = written({{"block", kBlock}});
  for (const double share : {0.01, 0.3, 0.6, 0.99}) {
    const std::string cut = whole.substr(0, static_cast<std::size_t>(share * static_cast<double>(whole.size())));
    const std::string error = error_of(ErrorKind::input, [&] { static_cast<void>(load_model("cut.step", cut, {})); });
    EXPECT_TRUE(error.starts_with("cut.step:")) << error;
  }
}

// Bytes overwritten here and there, head and tail whole: the kernel reads it, refuses it or crashes, and none of that
// reaches the caller but as an Error(input) or a part.
TEST_F(Step, DamagedInTheMiddleIsRefusedOrRead) {
  const std::string whole = written({{"block", kBlock}});
  const std::size_t data = whole.find("DATA;");
  for (std::size_t trial = 0; trial < 12; ++trial) {
    std::string damaged = whole;
    for (std::size_t i = data + 97 * (trial + 1); i + 200 < damaged.size(); i += 601 + 97 * trial)
      damaged[i] = "#(9,'x"[trial % 6];
    try {
      for (const Part& part : load_model("damaged.step", damaged, {})) EXPECT_FALSE(part.name.empty());
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input) << error.what();
      EXPECT_TRUE(std::string(error.what()).starts_with("damaged.step:")) << error.what();
    }
  }
}

TEST_F(Step, WithoutASolidIsRefused) {
  const std::string empty =
      "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\n"
      "FILE_SCHEMA(('AUTOMOTIVE_DESIGN'));\nENDSEC;\nDATA;\nENDSEC;\nEND-ISO-10303-21;\n";
  const std::string error = error_of(ErrorKind::input, [&] { static_cast<void>(load_model("empty.step", empty, {})); });
  EXPECT_TRUE(error.starts_with("empty.step:")) << error;
}

TEST_F(Step, ThatCannotBeWrittenIsAnErrorOfTheDisk) {
  EXPECT_THROW(write_step("/nowhere/a.step", {{"block", kBlock}}), Error);
}

TEST_F(Step, OfASolidThatIsNoneIsRefusedBeforeAnythingIsStarted) {
  EXPECT_THROW(write_step(path_, {{"bad", make(Kind::sphere, {-1})}}), Error);
  EXPECT_FALSE(std::filesystem::exists(path_));
}

}  // namespace
}  // namespace verisim::step_file_test
