#include "services/robot/core/inspire_emulator.hpp"

#include <algorithm>
#include <cmath>

namespace prehend::robot::inspire {
namespace {

constexpr Duration gap = std::chrono::milliseconds(20);  // a frame has no longer pause
constexpr Duration stalls_after = std::chrono::milliseconds(120);
constexpr Duration fails_after = std::chrono::milliseconds(500);
constexpr double there = 3;  // counts
constexpr int too_hot = 70;  // °C

constexpr std::array shown_blocks{table::angle_set, table::force_set, table::speed_set,
                                  table::angle_now, table::force_now, table::current_now,
                                  table::error,     table::status,    table::temperature};

}  // namespace

Expected<std::unique_ptr<robot::Emulator>> emulate(const model::HandModel& hand,
                                                   const EmulatedOptions& options) {
  if (auto fits = check_hand(hand); !fits) return tl::unexpected(fits.error());
  return std::make_unique<Emulator>(hand, options);
}

Emulator::Emulator(const model::HandModel& hand, const EmulatedOptions& options)
    : hand_(hand),
      options_(options),
      id_(options.id == 0 ? usual_id : static_cast<std::uint8_t>(options.id)),
      answers_as_(options.answers_as == 0 ? id_ : static_cast<std::uint8_t>(options.answers_as)) {
  for (std::size_t i = 0; i < motors; ++i) {
    const model::HandDof& dof = hand.dofs()[i];
    Unit& unit = units_[i];
    unit.squeeze = std::abs(open_count * dof.squeeze / (dof.upper - dof.lower));
    const double open = hand.postures().at("open")[static_cast<Eigen::Index>(i)];
    unit.position = unit.driven = unit.seen = std::round(count_of(dof, open));
  }
  restart();
}

void Emulator::restart() {
  for (Unit& unit : units_) {
    unit.goal = static_cast<int>(std::lround(unit.position));
    unit.force = unit.speed = full;
    unit.error = 0;
    unit.still_since = now_;
  }
}

std::string Emulator::pass(Duration now) {
  const double dt = to_seconds(now - now_);
  now_ = now;
  if (!parser_.is_empty() && now - heard_ > gap) parser_.clear();
  for (Unit& unit : units_) {
    if (celsius_ > too_hot) unit.error |= hot;
    move(unit, dt);
    watch(unit);
  }
  return {};
}

void Emulator::move(Unit& unit, double dt) const {
  const double step =
      open_count / fastest_stroke * unit.speed / full * dt * options_.velocity_scale;
  if (unit.error == 0) unit.driven += std::clamp(unit.goal - unit.driven, -step, step);
  const bool stands = now_ - unit.still_since > stalls_after / 2;
  const double most = unit.squeeze * (stands ? static_cast<double>(unit.force) / full : 1);
  if (unit.blocked)
    unit.driven = unit.position;
  else if (twin_)
    unit.driven = unit.position + std::clamp(unit.driven - unit.position, -most, most);
  else
    unit.position = unit.driven;
}

void Emulator::watch(Unit& unit) const {
  const bool is_there = std::abs(unit.goal - unit.position) <= there;
  if (is_there || std::abs(unit.position - unit.seen) > 2) {
    unit.seen = unit.position;
    unit.still_since = now_;
  }
  const Duration still = now_ - unit.still_since;
  if (unit.blocked && still > fails_after) unit.error |= stall;
  if (unit.error != 0)
    unit.status = failed;
  else if (is_there)
    unit.status = arrived;
  else if (still > stalls_after && !unit.blocked)
    unit.status = at_force;
  else
    unit.status = unit.goal < unit.position ? closing : opening;
}

Eigen::VectorXd Emulator::driven() const {
  Eigen::VectorXd dof(static_cast<Eigen::Index>(motors));
  for (std::size_t i = 0; i < motors; ++i)
    dof[static_cast<Eigen::Index>(i)] = dof_of(hand_.dofs()[i], units_[i].driven);
  return dof;
}

Eigen::VectorXd Emulator::measured() const {
  Eigen::VectorXd dof(static_cast<Eigen::Index>(motors));
  for (std::size_t i = 0; i < motors; ++i)
    dof[static_cast<Eigen::Index>(i)] = dof_of(hand_.dofs()[i], units_[i].position);
  return dof;
}

void Emulator::measure(const Eigen::VectorXd& dof) {
  twin_ = true;
  for (std::size_t i = 0; i < motors; ++i)
    if (!units_[i].blocked)
      units_[i].position = count_of(hand_.dofs()[i], dof[static_cast<Eigen::Index>(i)]);
}

// --- what is said

std::string Emulator::receive(std::string_view bytes, Duration now) {
  pass(now);
  heard_ = now;
  parser_.feed(bytes);
  std::string said;
  while (const auto question = parser_.next()) {
    if (question->id != id_) continue;
    const auto data = answer(*question);
    if (!data) continue;
    said += encode(Side::answers, {answers_as_, question->command, question->address, *data});
  }
  return said;
}

/// To what it does not know it says nothing.
std::optional<std::string> Emulator::answer(const Frame& question) {
  if (question.command == Command::write)
    return write(question) ? std::optional<std::string>("\1") : std::nullopt;
  if (question.command != Command::read || question.data.size() != 1) return std::nullopt;
  for (const Block& block : shown_blocks)
    if (block.address == question.address && question.data[0] == block.bytes())
      return bytes_of(block, shown(block));
  return std::nullopt;
}

bool Emulator::write(const Frame& question) {
  if (question.address == table::clear_error) {
    for (Unit& unit : units_) {
      unit.error = 0;
      unit.still_since = now_;
    }
    return true;
  }
  const Block block{question.address, 2};
  const auto values = values_of(block, question.data);
  if (!values) return false;
  for (std::size_t i = 0; i < motors; ++i) {
    const int value = (*values)[i];
    if (value < 0 || value > full) continue;  // as it was
    Unit& unit = units_[i];
    if (block.address == table::angle_set.address) {
      if (unit.status == arrived && value != unit.goal) unit.still_since = now_;
      unit.goal = value;
    } else if (block.address == table::force_set.address) {
      unit.force = value;
    } else if (block.address == table::speed_set.address) {
      unit.speed = value;
    } else {
      return false;
    }
  }
  return true;
}

Values Emulator::shown(const Block& block) const {
  Values values{};
  for (std::size_t i = 0; i < motors; ++i) {
    const Unit& unit = units_[i];
    const double presses = (unit.position - unit.driven) / unit.squeeze * full;
    switch (block.address) {
      case table::angle_set.address:
        values[i] = unit.goal;
        break;
      case table::force_set.address:
        values[i] = unit.force;
        break;
      case table::speed_set.address:
        values[i] = unit.speed;
        break;
      case table::angle_now.address:
        values[i] = static_cast<int>(std::lround(unit.position));
        break;
      case table::force_now.address:
        values[i] = static_cast<int>(std::lround(unit.status == at_force ? presses : 0));
        break;
      case table::error.address:
        values[i] = unit.error;
        break;
      case table::status.address:
        values[i] = unit.status;
        break;
      case table::temperature.address:
        values[i] = static_cast<int>(std::lround(celsius_));
        break;
      default:
        values[i] = unit.status == at_force ? 300 : 0;
    }
  }
  return values;
}

}  // namespace prehend::robot::inspire
