#include <fmt/format.h>

#include <cmath>

#include "engine/wii/validate.hpp"

namespace verisim::wii {

namespace {

char mark_of(double nees, double lower, double upper) {
  if (nees > upper) return '!';
  return nees < lower ? '-' : ' ';
}

/// "1.2!", or a dash where no covariance was stated.
std::string nees_text(double nees, double lower, double upper) {
  return std::isnan(nees) ? "- " : fmt::format("{:.1f}{}", nees, mark_of(nees, lower, upper));
}

std::string or_dash(double value, int digits) {
  return std::isnan(value) ? "-" : fmt::format("{:.{}f}", value, digits);
}

/// Half the interval of the position's rms over the seeds.
std::string spread_of(const ValidationRow& r) {
  if (r.seeds == 1) return "";
  return fmt::format("{:>8.2f}", 50 * (r.position_rms_95.second - r.position_rms_95.first));
}

}  // namespace

std::string table_of(const std::vector<ValidationRow>& rows) {
  std::string text;
  std::string heading;
  for (const ValidationRow& r : rows) {
    const std::string here = fmt::format("{}, {}", r.sensor, r.trajectory);
    if (here != heading) {
      text += fmt::format("\n{:<28}{:>9}{}{:>8}{:>8}{:>9}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}\n", here, "cm rms",
                          r.seeds == 1 ? "" : "   +-cm ", "95 %", "max", "deg rms", "yaw", "roll", "avail %", "lag ms",
                          "nees", "in 95%", "o-nees", "ns");
      heading = here;
    }
    text += fmt::format(
        "  {:<26}{:>9.2f}{}{:>8.2f}{:>8.2f}{:>9.2f}{:>8.2f}{:>8.2f}{:>8.1f}{:>8.1f}{:>8}{:>8}{:>8}{:>8}\n", r.tracker,
        100 * r.position.rms, spread_of(r), 100 * r.position.p95, 100 * r.position.max, r.orientation.rms,
        r.orientation.rms_axis.y(), r.orientation.rms_axis.z(), 100 * r.availability, 1000 * r.latency,
        nees_text(r.nees, r.nees_lower, r.nees_upper), or_dash(100 * r.within_95, 1),
        nees_text(r.orientation_nees, r.orientation_nees_lower, r.orientation_nees_upper), or_dash(r.update_ns, 0));
  }
  return text +
         "\nnees, of the position, and o-nees, of the orientation: ! = errors beyond what the covariance promises, - = "
         "well within it (2.5 and\n97.5 % bounds of chi-square)\n";
}

std::string csv_of(const std::vector<ValidationRow>& rows) {
  std::string text =
      "sensor,trajectory,tracker,reports,valid,availability,false_validity,reacquired,longest_return_s,"
      "position_rms_m,position_p95_m,position_max_m,position_rms_x_m,position_rms_y_m,position_rms_z_m,"
      "orientation_rms_deg,orientation_p95_deg,orientation_max_deg,orientation_rms_x_deg,orientation_rms_y_deg,"
      "orientation_rms_z_deg,latency_s,nees,nees_lower,nees_upper,consistent,within_95,update_ns,orientation_nees,"
      "orientation_nees_lower,orientation_nees_upper,seeds,position_rms_low_m,position_rms_high_m,"
      "orientation_rms_low_deg,orientation_rms_high_deg\n";
  const auto figures = [](const ErrorFigures& f) {
    return fmt::format("{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g}", f.rms, f.p95, f.max, f.rms_axis.x(), f.rms_axis.y(),
                       f.rms_axis.z());
  };
  for (const ValidationRow& r : rows) {
    text += fmt::format("{},{},{},{},{},{:.6g},{:.6g},{},{:.6g},{},{},{:.6g},{:.6g},{:.6g},{:.6g},{:d},{:.6g},{:.4g}",
                        r.sensor, r.trajectory, r.tracker, r.reports, r.valid, r.availability, r.false_validity,
                        r.reacquired, r.longest_return, figures(r.position), figures(r.orientation), r.latency, r.nees,
                        r.nees_lower, r.nees_upper, r.consistent, r.within_95, r.update_ns);
    text += fmt::format(",{:.6g},{:.6g},{:.6g},{}", r.orientation_nees, r.orientation_nees_lower,
                        r.orientation_nees_upper, r.seeds);
    // Of one seed there is no interval: empty fields.
    text += r.seeds == 1
                ? ",,,,\n"
                : fmt::format(",{:.6g},{:.6g},{:.6g},{:.6g}\n", r.position_rms_95.first, r.position_rms_95.second,
                              r.orientation_rms_95.first, r.orientation_rms_95.second);
  }
  return text;
}

std::string markdown_of(const std::vector<ValidationRow>& rows) {
  std::string text;
  std::string sensor;
  std::string path;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const ValidationRow& r = rows[i];
    if (r.sensor != sensor) {
      std::string rule = "|---|";
      text += fmt::format("{}| {} |", sensor.empty() ? "" : "\n\n", r.sensor);
      for (std::size_t j = i; j < rows.size() && rows[j].sensor == r.sensor && rows[j].trajectory == r.trajectory;
           ++j) {
        text += fmt::format(" {} |", rows[j].tracker);
        rule += "---:|";
      }
      text += "\n" + rule;
      sensor = r.sensor;
      path.clear();
    }
    if (r.trajectory != path) text += fmt::format("\n| {} |", r.trajectory);
    path = r.trajectory;
    text += fmt::format(" {:.2f} ({:.1f}) |", 100 * r.position.rms, 100 * r.availability);
  }
  return text + "\n";
}

}  // namespace verisim::wii
