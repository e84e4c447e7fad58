#include "engine/cli/wii_rows.hpp"
#include "engine/base/json.hpp"

#include <cmath>
#include <filesystem>

#include "engine/base/error.hpp"
#include "engine/record/output_place.hpp"
#include "engine/wii/validation_plot.hpp"

namespace verisim::cli {
namespace {

namespace fs = std::filesystem;

Json json_of_figures(const wii::ErrorFigures& f) {
  return {
      {"rms", f.rms}, {"p95", f.p95}, {"max", f.max}, {"rms_axis", {f.rms_axis.x(), f.rms_axis.y(), f.rms_axis.z()}}};
}

Json known(double value) {
  return std::isnan(value) ? Json(nullptr) : Json(value);
}

}  // namespace

Json row_json(const wii::ValidationRow& r) {
  Json j = {{"sensor", r.sensor},
            {"trajectory", r.trajectory},
            {"tracker", r.tracker},
            {"reports", r.reports},
            {"valid", r.valid},
            {"position_m", json_of_figures(r.position)},
            {"orientation_deg", json_of_figures(r.orientation)},
            {"availability", r.availability},
            {"false_validity", r.false_validity},
            {"latency_s", r.latency},
            {"nees", known(r.nees)},
            {"nees_lower", known(r.nees_lower)},
            {"nees_upper", known(r.nees_upper)},
            {"consistent", r.consistent},
            {"within_95", known(r.within_95)},
            {"orientation_nees", known(r.orientation_nees)},
            {"orientation_nees_lower", known(r.orientation_nees_lower)},
            {"orientation_nees_upper", known(r.orientation_nees_upper)},
            {"reacquired", r.reacquired},
            {"longest_return_s", r.longest_return},
            {"update_ns", known(r.update_ns)},
            {"seeds", r.seeds}};
  if (r.seeds > 1) {
    j["position_rms_95_m"] = {r.position_rms_95.first, r.position_rms_95.second};
    j["orientation_rms_95_deg"] = {r.orientation_rms_95.first, r.orientation_rms_95.second};
  }
  return j;
}

std::string stem_of(const OutOptions& out) {
  return fs::path(out.path).replace_extension().string();
}

void check_row_files(const OutOptions& out, const std::vector<FileIdentity>& inputs) {
  if (fs::path(out.path).extension() == ".svg")
    fail(ErrorKind::usage, "-o {}: names the table, beside which the plot has this name; let it end in .csv", out.path);
  (void)check_output({out.path, OutputKind::text, out.force, beginning_of(wii::csv_of({}))}, inputs);
  (void)check_output({stem_of(out) + ".svg", OutputKind::text, out.force, beginning_of(wii::overview_plot({}))},
                     inputs);
}

void write_row_files(const OutOptions& out, const std::vector<wii::ValidationRow>& rows,
                     const std::vector<FileIdentity>& inputs) {
  write_text(out.path, wii::csv_of(rows), out.force, inputs);
  write_text(stem_of(out) + ".svg", wii::overview_plot(rows), out.force, inputs);
}

}  // namespace verisim::cli
