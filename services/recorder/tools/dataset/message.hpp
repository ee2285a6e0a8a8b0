#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>

#include "common/base/pose.hpp"
#include "common/recording/types/value.hpp"

/// Fields of a decoded message, checked: nothing where the field is missing, is of another kind or
/// is not finite.
namespace prehend::recorder::dataset {

using recording::types::Value;

std::optional<double> number(const Value& message, std::string_view field);
/// Text, or the name of an enumerator; empty: none.
std::string text(const Value& message, std::string_view field);
bool flag(const Value& message, std::string_view field);
std::optional<Eigen::VectorXd> numbers(const Value& message, std::string_view field);
std::optional<Eigen::Vector3d> vector(const Value& message, std::string_view field);
std::optional<Pose> pose(const Value& message, std::string_view field);

/// Keys of topics become names of columns, groups and files: what cannot stand in all of these is
/// «_».
std::string as_name(std::string key);

}  // namespace prehend::recorder::dataset
