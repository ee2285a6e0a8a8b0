#pragma once

#include "services/recorder/core/dataset/recording_log.hpp"

namespace prehend::recorder::dataset {

inline Time ms(int t) {
  return from_ns(1'700'000'000'000'000'000) + std::chrono::milliseconds(t);
}

/// A hand of two DoFs that is led for so long, from 0: its commands are t in s and -t, every 20 ms;
/// it follows by 10 ms later. Its base goes along x at 1 m/s and does not turn.
inline RecordingLog lead_for(int duration_ms) {
  RecordingLog log;
  log.model = "test";
  for (int t = 0; t <= duration_ms; t += 20) {
    const double s = t * 1e-3;
    log.command_dof.add(ms(t), Eigen::Vector2d(s, -s));
    log.command_X_WB.add(ms(t), make_pose({s, 0, 0}));
    log.command_object.add(ms(t), "Cup");
    log.dof.add(ms(t), Eigen::Vector2d(s - 0.01, 0.01 - s));
    log.joint.add(ms(t), Eigen::Vector3d(s, 2 * s, 3 * s));
    log.velocity.add(ms(t), Eigen::Vector3d(1, 2, 3));
    log.torque.add(ms(t), Eigen::Vector3d(0.1, 0.2, 0.3));
    log.X_WB.add(ms(t), make_pose({s - 0.01, 0, 0}));
  }
  return log;
}

}  // namespace prehend::recorder::dataset
