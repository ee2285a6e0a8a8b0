#pragma once

#include <array>
#include <span>
#include <string_view>

namespace prehend::architecture {

/// Sources in `from` may include headers of `to`.
struct Edge {
  std::string_view from, to;
};

/// What is let pass, and why.
struct Exception {
  std::string_view file;
  std::string_view what;  // the header, the word or the function; rules say which
  std::string_view reason;
};

/// A name that was given up for another.
struct Retired {
  std::string_view was, is;
  std::string_view where = {};  // the folder, anywhere, in which it meant that; empty: all
};

/// What the rules leave to the house to say. An entry that nothing needs breaks its rule.
struct Agreed {
  std::span<const Edge> edges;                // between folders of common; idl is one, too
  std::span<const Exception> impure_cores;    // what: the header
  std::span<const Exception> long_functions;  // what: a piece of the signature; may only shrink
  std::span<const Exception> ends;            // what: the function that ends the process
  std::span<const Exception> commands;        // what: the function that adds a subcommand
  std::span<const Exception> raw_targets;     // what: the name of the target
  std::span<const Exception> long_pages;      // what: «the page», or the heading of a section
  std::span<const Retired> retired;           // those of the glossary, and functions
};

/// Where these tables stand.
inline constexpr std::string_view agreed_file = "tests/architecture/agreed.hpp";

inline constexpr std::array common_edges{
    Edge{"common/analysis", "common/base"},
    Edge{"common/analysis", "common/model"},
    Edge{"common/arm", "common/base"},
    Edge{"common/arm", "common/model"},
    Edge{"common/audit", "common/base"},
    Edge{"common/carrying", "common/arm"},
    Edge{"common/carrying", "common/base"},
    Edge{"common/carrying", "common/grasping"},
    Edge{"common/carrying", "common/model"},
    Edge{"common/clock", "common/base"},
    Edge{"common/clock", "idl"},
    Edge{"common/convert", "common/base"},
    Edge{"common/convert", "common/model"},
    Edge{"common/convert", "idl"},
    Edge{"common/dds", "common/base"},
    Edge{"common/dds", "common/dds/guard"},
    Edge{"common/dds", "common/dds/release"},
    Edge{"common/dds", "common/keys"},
    Edge{"common/dds", "idl"},
    Edge{"common/dds/guard", "common/base"},
    Edge{"common/dds/guard", "common/dds/release"},
    Edge{"common/dds/guard", "common/keys"},
    Edge{"common/gate", "common/base"},
    Edge{"common/gate", "common/model"},
    Edge{"common/grasping", "common/analysis"},
    Edge{"common/grasping", "common/base"},
    Edge{"common/grasping", "common/model"},
    Edge{"common/keys", "common/base"},
    Edge{"common/learning", "common/base"},
    Edge{"common/learning", "common/proto"},
    Edge{"common/model", "common/base"},
    Edge{"common/planning", "common/arm"},
    Edge{"common/planning", "common/base"},
    Edge{"common/planning", "common/grasping"},
    Edge{"common/planning", "common/model"},
    Edge{"common/proto", "common/base"},
    Edge{"common/recording/compare", "common/base"},
    Edge{"common/recording/compare", "common/recording/mcap"},
    Edge{"common/recording/compare", "common/recording/types"},
    Edge{"common/recording/layout", "common/base"},
    Edge{"common/recording/layout", "common/dds"},
    Edge{"common/recording/layout", "common/recording/mcap"},
    Edge{"common/recording/mcap", "common/base"},
    Edge{"common/recording/messages", "common/base"},
    Edge{"common/recording/messages", "common/recording/compare"},
    Edge{"common/recording/messages", "common/recording/mcap"},
    Edge{"common/recording/messages", "common/recording/types"},
    Edge{"common/recording/types", "common/base"},
    Edge{"common/robot", "common/audit"},
    Edge{"common/robot", "common/base"},
    Edge{"common/robot", "common/convert"},
    Edge{"common/robot", "common/dds"},
    Edge{"common/robot", "common/gate"},
    Edge{"common/robot", "common/model"},
    Edge{"common/robot", "common/service"},
    Edge{"common/robot", "idl"},
    Edge{"common/ros2", "common/base"},
    Edge{"common/ros2/nodes", "common/base"},
    Edge{"common/ros2/nodes", "common/dds"},
    Edge{"common/serial", "common/base"},
    Edge{"common/service", "common/base"},
    Edge{"common/service", "common/clock"},
    Edge{"common/service", "common/dds"},
    Edge{"common/service", "common/dds/guard"},
    Edge{"common/service", "common/tool"},
    Edge{"common/service", "idl"},
    Edge{"common/stage", "common/arm"},
    Edge{"common/stage", "common/base"},
    Edge{"common/stage", "common/dds"},
    Edge{"common/stage", "common/model"},
    Edge{"common/stage", "common/service"},
    Edge{"common/stage", "common/tool"},
    Edge{"common/stage", "idl"},
    Edge{"common/statistics", "common/base"},
    Edge{"common/tasks", "common/base"},
    Edge{"common/tasks", "common/model"},
    Edge{"common/tasks/files", "common/base"},
    Edge{"common/tasks/files", "common/model"},
    Edge{"common/tasks/files", "common/proto"},
    Edge{"common/tasks/files", "common/tasks"},
    Edge{"common/tool", "common/base"},
    Edge{"common/web", "common/base"},
};

inline constexpr std::string_view older = "older than the rule";

inline constexpr std::array long_functions{
    Exception{"common/service/config_keys.cpp", "config_keys(", "a table: a row a key"},
    Exception{"tests/benchmark/glove_driver.cpp", "measure(", older},
    Exception{"tests/integration/flood_test.cpp", "Flood::flood(", older},
    Exception{"tests/integration/profiles_test.cpp", "SitesBehindRoutersMeetAtForwardedPortsAlone)",
              older},
    Exception{"tests/integration/replay_test.cpp", "EasesTheHandToWhereTheRecordingBegins)", older},
    Exception{"tests/integration/security_test.cpp",
              "IntrudersGetNothingBringNothingAndTheOthersGoOn)", older},
    Exception{"tests/integration/security_test.cpp", "BrokenKeysStopAProcess)", older},
    Exception{"tests/integration/simulation_test.cpp", "GraspsWhatWasSeenAndReportsIt)", older},
    Exception{"tests/unit/dds/raw_test.cpp", "BytesKeysEndsAndStampsPassThrough)", older},
    Exception{"tests/unit/hand_model/hand_file_test.cpp", "RefusesWhatIsNoHandAndSaysWhere)",
              older},
    Exception{"tests/unit/mapping/wild_input_test.cpp", "NeverMovesFasterThanTheLimits)", older},
    Exception{"tests/unit/service/lockstep_test.cpp", "play(", older},
};

inline constexpr std::array process_ends{
    Exception{"common/stage/process.cpp", "_exit",
              "the child between fork and exec, which must not run the parent's destructors"},
    Exception{"common/service/restart.cpp", "_Exit",
              "exec failed, and nothing is left to return to"},
    Exception{"common/service/shell.cpp", "_Exit", "the watchdog: Fast DDS cannot even be left"},
};

inline constexpr std::array raw_targets{
    Exception{"common/proto/CMakeLists.txt", "common_proto_messages",
              "generated sources, compiled without our warnings"},
};

// «(was X)» in docs/glossary.md.
inline constexpr std::array retired{
    Retired{"Arrival", "FingerDistances", "mapping"},
    Retired{"BetweenSites", "WanTransport"},
    Retired{"Claim", "PortLock", "dds"},
    Retired{"DeafnessWatch", "DeadlockWatchdog"},
    Retired{"Ear", "DiscoveryListener"},
    Retired{"Figures", "Stats"},
    Retired{"figures", "stats"},
    Retired{"Gate", "SerializedTransport", "dds"},
    Retired{"Grip", "GripController"},
    Retired{"LearntPlace", "PalmOffset"},
    Retired{"mend", "hint"},
    Retired{"RightOfWay", "FingerCollisionLimiter"},
    Retired{"Standing", "LatchedSamples"},
};

/// What this house has agreed on.
inline constexpr Agreed agreed_here{common_edges, {}, long_functions, process_ends, {},
                                    raw_targets,  {}, retired};

}  // namespace prehend::architecture
