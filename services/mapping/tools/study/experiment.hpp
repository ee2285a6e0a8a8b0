#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "services/mapping/tools/study/chart.hpp"
#include "services/mapping/tools/study/finding.hpp"
#include "services/mapping/tools/study/parts.hpp"

namespace prehend::mapping {

/// The hands of the thesis: findings about all its hands, and the grasp benchmark, are of these.
inline constexpr std::array thesis_hands{"barrett", "dlr", "robonaut"};

/// One repetition of an experiment: another person, other first weights.
struct Repetition {
  std::size_t index = 0;   // for what is taken in turn
  std::uint64_t seed = 1;  // of everything that is drawn
};

/// What repetitions have measured: a row each, not-a-number where there was nothing to measure.
struct Table {
  std::vector<std::string> columns;
  Eigen::MatrixXd values;

  /// All repetitions of one column. The name must be one of them.
  std::vector<double> operator[](std::string_view column) const;
};

/// A header and a line a repetition.
std::string to_csv(const Table& table);

struct Outcome {
  std::vector<Finding> findings;
  Chart chart;
};

/// A figure of [Thesis]: what is measured once, and how many repetitions of it are judged.
struct Experiment {
  std::string figure;              // «5.14»
  std::string title;               // what is shown
  std::string method;              // how it is measured
  std::vector<std::string> hands;  // that it needs
  std::vector<std::string> columns;
  std::size_t quick = 0, full = 0;  // repetitions
  /// A row for the columns. Pure: several threads call it at once.
  std::function<Eigen::VectorXd(const Parts&, const Repetition&)> repeat;
  std::function<Outcome(const Table&)> judge;
  bool trained = false;     // needs the trained models
  bool recordings = false;  // needs recordings of real hands
};

/// Figures 5.12 and 5.13: how the methods converge, and what error they come to.
Experiment convergence();
Experiment lowest_error();
/// Figures 5.14 to 5.16: how many hidden neurons.
Experiment hidden_neurons_barrett();
Experiment hidden_neurons_dlr();
Experiment hidden_neurons_robonaut();
/// Figure 5.18: how many postures to train.
Experiment posture_counts();
/// Figure 6.2: direct mapping on grasps that it has learnt.
Experiment direct_grasps();
/// Figures 6.5, 6.7, 6.9: direct against intelligent mapping.
Experiment cylinders();
Experiment boxes();
Experiment small_cube();
/// Figures 6.6 and 6.8: the object's size told wrong.
Experiment wrong_radius();
Experiment wrong_depth();
/// Beyond the figures: the scaling equations, and what an intelligent network is told of the size.
Experiment scalings();
Experiment size_inputs();
/// The live mapping on sizes that it was not trained on, and on the fingers of real hands.
Experiment untrained_sizes();
Experiment real_hands();

/// All of them in the order of [Thesis].
std::vector<Experiment> experiments();

/// The seed of a repetition: the same figure, repetition and study seed give the same one.
std::uint64_t repetition_seed(std::uint64_t study_seed, std::string_view figure, std::size_t index);

}  // namespace prehend::mapping
