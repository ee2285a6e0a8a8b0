#include "common/analysis/linear_program.hpp"

#include <ClpSimplex.hpp>
#include <limits>
#include <numeric>
#include <vector>

namespace prehend::analysis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// Of the solver's: how far a constraint may be missed. Its own default is 1e-7.
constexpr double solver_tolerance = 1e-9;

}  // namespace

LinearProgram::LinearProgram(Index variables, Index constraints)
    : cost(VectorXd::Zero(variables)),
      rows(Eigen::MatrixXd::Zero(constraints, variables)),
      row_lower(VectorXd::Zero(constraints)),
      row_upper(VectorXd::Zero(constraints)),
      lower(VectorXd::Zero(variables)),
      upper(VectorXd::Constant(variables, std::numeric_limits<double>::infinity())) {}

Expected<std::optional<VectorXd>> minimise(const LinearProgram& program) {
  if (!program.cost.allFinite() || !program.rows.allFinite() || program.lower.hasNaN() ||
      program.upper.hasNaN() || program.row_lower.hasNaN() || program.row_upper.hasNaN())
    return fail("a linear program needs finite numbers");
  const int rows = static_cast<int>(program.rows.rows());
  const int columns = static_cast<int>(program.rows.cols());
  // Dense columns: each holds all rows, in order.
  std::vector<CoinBigIndex> starts(static_cast<std::size_t>(columns) + 1);
  for (int column = 0; column <= columns; ++column)
    starts[static_cast<std::size_t>(column)] = column * rows;
  std::vector<int> indices(static_cast<std::size_t>(rows * columns));
  for (std::size_t i = 0; i < indices.size(); ++i)
    indices[i] = static_cast<int>(i % static_cast<std::size_t>(rows));
  ClpSimplex solver;
  solver.setLogLevel(0);
  solver.scaling(0);  // would blow up a row that holds nothing but rounding, and find no solution
  solver.setPrimalTolerance(solver_tolerance);
  solver.setDualTolerance(solver_tolerance);
  solver.loadProblem(columns, rows, starts.data(), indices.data(), program.rows.data(),
                     program.lower.data(), program.upper.data(), program.cost.data(),
                     program.row_lower.data(), program.row_upper.data());
  solver.primal();
  if (solver.isProvenOptimal()) {
    const VectorXd x = Eigen::Map<const VectorXd>(solver.primalColumnSolution(), columns);
    return x;
  }
  if (solver.isProvenPrimalInfeasible()) return std::optional<VectorXd>();
  if (solver.isProvenDualInfeasible()) return fail("the linear program has no lower bound");
  return fail("the linear program was not solved");
}

}  // namespace prehend::analysis
