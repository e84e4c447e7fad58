// The doors of engine/record: what is stored. What is read is refused if it is damaged (run_file_test, trace_test).
#include <gtest/gtest.h>
#include <hdf5.h>

#include <limits>

#include "engine/record/run_file.hpp"
#include "engine/record/trace.hpp"
#include "tests/record/small_run.hpp"
#include "tests/support/broken.hpp"
#include "tests/support/refusal.hpp"

namespace verisim::record_contracts_test {
namespace {

using small_run::Folder;
using small_run::schema;

Column column(const std::string& path, std::size_t width) {
  return {.path = path, .dtype = Dtype::f64, .width = width, .units = "", .description = "", .enum_names = {}};
}

TEST(SchemaDeathTest, HasColumnsWithAPathAndAWidth) {
  Schema s;
  EXPECT_BROKEN(s.add(column("state/time", 1)), "column.path.starts_with('/')");
  EXPECT_BROKEN(s.add(column("/state/time", 0)), "column.width > 0");
}

TEST(RecorderDeathTest, TakesEventsThatHaveATimeAndAKind) {
  const Folder folder;
  EXPECT_BROKEN(
      {
        Recorder recorder(folder.file("run.h5"), schema(), {}, {});
        recorder.event(std::numeric_limits<double>::quiet_NaN(), "grasp", "");
      },
      "std::isfinite(time)");
  EXPECT_BROKEN(
      {
        Recorder recorder(folder.file("run.h5"), schema(), {}, {});
        recorder.event(0, "", "text");
      },
      "!kind.empty()");
}

TEST(RecorderDeathTest, HasOneRowOpenAtATime) {
  const Folder folder;
  EXPECT_BROKEN(
      {
        Recorder recorder(folder.file("run.h5"), schema(), {}, {});
        recorder.end_row();
      },
      "row_open_");
  EXPECT_BROKEN(
      {
        Recorder recorder(folder.file("run.h5"), schema(), {}, {});
        (void)recorder.begin_row();
        (void)recorder.begin_row();
      },
      "!row_open_");
}

TEST(TraceDeathTest, IsWrittenAsAWholeTable) {
  Trace trace;
  EXPECT_BROKEN(write_trace("/nowhere.csv", trace), "!trace.columns.empty()");
  trace.columns = {"t", "px"};
  trace.values = {0, 1};
  EXPECT_BROKEN(trace.at(1, 0), "row * columns.size() + column < values.size()");
  EXPECT_BROKEN(trace.at(0, 2), "column < columns.size()");
  trace.values = {0};
  EXPECT_BROKEN(write_trace("/nowhere.csv", trace), "trace.values.size() % trace.columns.size() == 0");
}

void set_order(hid_t file, const char* path, std::int64_t order) {
  const hid_t dataset = H5Dopen2(file, path, H5P_DEFAULT);
  const hid_t attribute = H5Aopen(dataset, "order", H5P_DEFAULT);
  ASSERT_GE(H5Awrite(attribute, H5T_NATIVE_INT64, &order), 0);
  H5Aclose(attribute);
  H5Dclose(dataset);
}

// Schema asserts that state comes first; a file that says otherwise must not reach that.
TEST(RunFile, RefusesColumnsOfWhichTheStateDoesNotComeFirst) {
  const Folder folder;
  const Schema columns = schema();
  { small_run::write(folder.file("run.h5"), 3); }
  std::size_t last = 0;  // of the state, and the column behind it
  while (columns.columns()[last + 1].path.starts_with("/state/") && columns.columns()[last + 1].path != "/state/hash")
    ++last;
  const hid_t file = H5Fopen(folder.file("run.h5").c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  set_order(file, columns.columns()[last].path.c_str(), static_cast<std::int64_t>(last + 1));
  set_order(file, columns.columns()[last + 1].path.c_str(), static_cast<std::int64_t>(last));
  H5Fclose(file);
  test::expect_refused([&] { return RunFile(folder.file("run.h5")).rows(); },
                       "stands behind columns that are not state");
}

}  // namespace
}  // namespace verisim::record_contracts_test
