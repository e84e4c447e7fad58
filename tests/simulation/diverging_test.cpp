// A simulation that diverges ends with an error that says when, what and what to do, in the frame in which it happens.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <map>

#include "engine/base/error.hpp"
#include "engine/base/finite.hpp"
#include "tests/length.hpp"
#include "tests/simulation/scenes.hpp"
#include "tests/support/random_inputs.hpp"

namespace verisim::diverging_test {
namespace {

/// Stands still, and after some frames is nowhere.
class LostDevice final : public Device {
 public:
  explicit LostDevice(std::uint64_t lost_at) : lost_at_(lost_at) {}
  [[nodiscard]] const std::string& name() const override { return name_; }
  [[nodiscard]] std::string described() const override { return name_; }
  void sample(const DeviceFrame& frame) override {
    if (frame.number == lost_at_) reading_.handle.position.y() = std::numeric_limits<double>::quiet_NaN();
  }
  [[nodiscard]] const DeviceReading& reading() const override { return reading_; }
  void render(const Wrench& wrench, const DeviceFrame&) override { rendered_ = wrench; }
  [[nodiscard]] const Wrench& rendered() const override { return rendered_; }
  [[nodiscard]] double duration() const override { return 0; }
  [[nodiscard]] double travel() const override { return 1; }
  [[nodiscard]] bool driven() const override { return true; }

 private:
  std::string name_ = "lost";
  std::uint64_t lost_at_;
  DeviceReading reading_;
  Wrench rendered_;
};

/// Steps until an Error; its text.
std::string end_of(Simulation& simulation) {
  try {
    while (simulation.frame() < simulation.frames_planned()) simulation.step();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::diverged);
    return error.what();
  }
  ADD_FAILURE() << "it ran to its end";
  return {};
}

TEST(Diverging, NamesTheDeviceThatIsNowhere) {
  Scene scene = scenes::pin_in_hole();
  scene.devices = {std::make_shared<LostDevice>(7)};
  Simulation simulation(scene, {});
  EXPECT_EQ(end_of(simulation), "frame 7: the handle of device 'lost' is not finite");
  EXPECT_EQ(simulation.frame(), 7U) << "the frames before it count";
}

TEST(Diverging, NamesTheBodyThatIsNowhere) {
  for (const Integrator integrator : {Integrator::semi_implicit, Integrator::implicit}) {
    Scene scene = scenes::falling_boxes(1, integrator);
    scene.parameters.gravity.z() = -std::numeric_limits<double>::max();
    scene.bodies[1].density = 1e5;  // a weight beyond the largest number
    Simulation simulation(scene, {});
    EXPECT_EQ(end_of(simulation),
              "frame 0: the state of 'box0' is not finite any more; lower the stiffness or the time step");
  }
}

/// Every f64 of the last frame's row and of its rows of the table.
void expect_finite(const Simulation& simulation, const Schema& schema, std::vector<std::byte>& row) {
  simulation.write_row(row.data());
  const auto expect = [&](const Column& column, const std::byte* at) {
    if (column.dtype != Dtype::f64) return;
    for (std::size_t i = 0; i < column.width; ++i) {
      double value = 0;
      std::memcpy(&value, at + column.offset + i * sizeof value, sizeof value);
      ASSERT_TRUE(std::isfinite(value)) << column.path << "[" << i << "] in frame " << simulation.frame() - 1;
    }
  };
  for (const Column& column : schema.columns()) expect(column, row.data());
  for (std::size_t at = 0; at < simulation.table_rows().size(); at += schema.table_row_bytes())
    for (const Column& column : schema.table()) expect(column, simulation.table_rows().data() + at);
}

/// Runs a scene to its end, whatever that is; its error's text, empty if there was none.
std::string run_to_any_end(const Scene& scene) {
  Simulation simulation(scene, {});
  Schema schema;
  simulation.describe(schema);
  std::vector<std::byte> row(schema.row_bytes());
  try {
    while (simulation.frame() < simulation.frames_planned()) {
      simulation.step();
      expect_finite(simulation, schema, row);
      if (::testing::Test::HasFailure()) return {};
    }
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::diverged) << error.what();
    return error.what();
  }
  return {};
}

/// 10^-limit to 10^limit.
double any_size(test::Inputs& inputs, double limit) {
  return std::pow(10, inputs.between(-limit, limit));
}

// Numbers of any size in all places: either all rows are finite, or the run ends in the frame in which one is not.
TEST(Diverging, NoRowHoldsANumberThatIsNone) {
  std::map<std::string, int> ends;
  for (const std::uint64_t seed : test::seeds(test::by_length(20, 60, 2000))) {
    SCOPED_TRACE(seed);
    test::Inputs inputs(seed);
    const Integrator integrator = seed % 2 == 0 ? Integrator::semi_implicit : Integrator::implicit;
    Scene scene = seed % 3 == 0 ? scenes::pin_in_hole() : scenes::falling_boxes(2, integrator);
    scene.parameters.integrator = integrator;
    scene.parameters.duration = 0.06;
    const double limit = seed % 4 < 2 ? 290 : 12;
    scene.parameters.gravity *= any_size(inputs, limit);
    scene.parameters.contact_stiffness *= any_size(inputs, limit);
    scene.parameters.contact_damping_ratio *= any_size(inputs, 6);
    scene.parameters.max_stiffness *= any_size(inputs, limit);
    for (BodyDescription& body : scene.bodies) {
      body.density *= any_size(inputs, 6);
      body.twist = {inputs.vector(any_size(inputs, 12)), inputs.vector(any_size(inputs, 6))};
    }
    const std::string end = run_to_any_end(scene);
    if (HasFailure()) return;
    const std::size_t from = end.find(": ");
    ++ends[end.empty() ? "done" : end.substr(from + 2, end.find_first_of("[ ", from + 2) - from - 2)];
  }
  EXPECT_GT(ends.size(), 2U) << "runs end in more than one way: else this test would prove little";
}

// A body's state is finite, and its energy is not: (1e160 m/s)^2.
TEST(Diverging, NamesTheColumnThatIsNotFinite) {
  Scene scene = scenes::falling_boxes(1, Integrator::semi_implicit);
  scene.bodies[1].twist.linear = {0, 0, 1e160};
  EXPECT_EQ(run_to_any_end(scene),
            "frame 0: /state/energy[0] is inf, not a finite number any more; lower the stiffness or the time step");
}

TEST(Diverging, FindsEveryNumberThatIsNoneWhereItStands) {
  std::vector<Column> columns;
  Column unknown;  // where NaN is a value
  unknown.may_be_nan = true;
  EXPECT_TRUE(FiniteNumbers({unknown}).all_in(std::vector<std::byte>(sizeof(double), std::byte{0xff}).data()));
  for (const auto& [dtype, width] : {std::pair{Dtype::f64, 1},
                                     {Dtype::u32, 3},
                                     {Dtype::f64, 2},
                                     {Dtype::u8, 1},
                                     {Dtype::f64, 6},
                                     {Dtype::f64, 7},
                                     {Dtype::u64, 1}}) {
    Column column;
    column.dtype = dtype;
    column.width = static_cast<std::size_t>(width);
    columns.push_back(column);
  }
  const FiniteNumbers numbers(columns);
  std::size_t bytes = 0;
  for (const Column& column : columns) bytes += column.bytes();
  std::size_t offset = 0;
  for (std::size_t c = 0; c < columns.size(); offset += columns[c++].bytes())
    for (std::size_t i = 0; i < columns[c].width; ++i)
      for (const double value : {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
                                 std::numeric_limits<double>::quiet_NaN(), -std::numeric_limits<double>::max(), 0.0}) {
        std::vector<std::byte> row(bytes, std::byte{0xff});  // whole numbers may have all bits
        for (std::size_t k = 0, at = 0; k < columns.size(); at += columns[k++].bytes())
          if (columns[k].dtype == Dtype::f64) std::memset(&row[at], 0, columns[k].bytes());
        if (columns[c].dtype == Dtype::f64) std::memcpy(&row[offset + i * sizeof value], &value, sizeof value);
        const bool bad = columns[c].dtype == Dtype::f64 && !std::isfinite(value);
        ASSERT_EQ(numbers.all_in(row.data()), !bad) << c << " " << i << " " << value;
        for (std::size_t from = 0, begin = 0; from < columns.size(); begin += columns[from++].bytes())
          for (std::size_t to = from, end = begin; to < columns.size(); ++to) {
            end += columns[to].bytes();
            ASSERT_EQ(numbers.all_in(row.data(), begin, end - begin), !bad || c < from || c > to) << from << " " << to;
          }
        const auto place = numbers.first_not_in(row.data());
        ASSERT_EQ(place.has_value(), bad);
        if (!bad) continue;
        EXPECT_EQ(place->column, c);
        EXPECT_EQ(place->component, i);
      }
}

}  // namespace
}  // namespace verisim::diverging_test
