#pragma once

#include <string>

namespace prehend::cli {

/// A UDP address of this host, «127.0.0.1:20123», whose port nobody has. No participant of a domain
/// will take it before it is used: theirs are the first of each 250 from 7400 on (DDSI-RTPS 2.3,
/// 9.6.1.1).
std::string free_address();

}  // namespace prehend::cli
