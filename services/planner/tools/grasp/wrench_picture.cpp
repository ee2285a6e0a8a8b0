#include "services/planner/tools/grasp/wrench_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "common/analysis/convex_hull.hpp"
#include "common/base/gnuplot.hpp"

namespace prehend::planner {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

std::string line(const Vector3d& p) {
  return fmt::format("{:.6g} {:.6g} {:.6g}\n", p.x(), p.y(), p.z());
}

/// gnuplot commands for one projection. name: unique, of its data blocks.
std::string projection(const std::string& name, const Eigen::Matrix3Xd& points,
                       const Vector3d& hardest, const std::string& title, const std::string& axis) {
  std::string data;
  bool solid = false;
  if (points.cols() > 0 && analysis::spans_all_dimensions(points)) {
    if (const auto hull = analysis::convex_hull(points)) {
      solid = true;
      for (Index facet = 0; facet < hull->vertices.cols(); ++facet) {
        for (const int corner : {0, 1, 2, 0})
          data += line(points.col(hull->vertices(corner, facet)));
        data += "\n\n";
      }
    }
  }
  if (!solid)
    for (Index i = 0; i < points.cols(); ++i) data += line(points.col(i));
  const double reach = std::max(points.cols() > 0 ? points.cwiseAbs().maxCoeff() : 0, 1e-9);
  std::string text = fmt::format(
      "${0} << EOD\n{1}EOD\n${0}_origin << EOD\n0 0 0\nEOD\n"
      "set title '{2}'\nset xlabel '{3}x'\nset ylabel '{3}y'\nset zlabel '{3}z'\nunset arrow\n"
      "set xrange [-{4}:{4}]\nset yrange [-{4}:{4}]\nset zrange [-{4}:{4}]\n",
      name, data.empty() ? "0 0 0\n" : data, title, axis, reach);
  if (const double length = hardest.norm(); length > 0) {
    const Vector3d tip = reach * hardest;
    text +=
        fmt::format("set arrow from 0,0,0 to {:.6g},{:.6g},{:.6g} lc rgb '#c02020' lw 2 front\n",
                    tip.x(), tip.y(), tip.z());
  }
  return text +
         fmt::format("splot ${0} {1}, ${0}_origin with points pt 7 ps 1.2 lc rgb 'black'\n", name,
                     solid ? "with polygons fs transparent solid 0.35 border lc rgb '#305080' "
                             "fc rgb '#4080c0'"
                           : "with points pt 7 ps 0.8 lc rgb '#4080c0'");
}

}  // namespace

Expected<void> draw_wrench_space(const Eigen::MatrixXd& wrenches,
                                 const analysis::Resistance& resistance,
                                 const std::filesystem::path& png) {
  const Eigen::VectorXd& hardest = resistance.weakest_direction;
  const std::string epsilon =
      resistance.force_closure ? fmt::format("ε = {:.4g}", resistance.epsilon) : "no force closure";
  return draw_by_gnuplot(
      "unset key\nset view 65,35,1.2\nset view equal xyz\nset xyplane relative 0.05\nset tics font "
      "',8'\n"
      "set grid\nset pm3d depthorder border lc rgb '#305080' lw 0.5\nset multiplot layout 1,2\n" +
          projection("forces", wrenches.topRows<3>(), hardest.head<3>(), "forces, " + epsilon,
                     "f") +
          projection("torques", wrenches.bottomRows<3>(), hardest.tail<3>(),
                     "torques over the torque scale", "t") +
          "unset multiplot\n",
      png, 1200, 600);
}

}  // namespace prehend::planner
