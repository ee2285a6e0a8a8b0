#pragma once

#include <filesystem>

namespace prehend {

/// Folder with models, trained networks and the default configuration: $PREHEND_SHARE, else
/// ../share/prehend beside the folder of the running program.
std::filesystem::path share_directory();

/// Folder for what must outlive a process: systemd's $STATE_DIRECTORY, else prehend in
/// $XDG_STATE_HOME or in ~/.local/state. Empty: there is none.
std::filesystem::path state_directory();

/// Folder for models that the user added: prehend in $XDG_DATA_HOME or in ~/.local/share. Empty:
/// there is none.
std::filesystem::path data_directory();

/// Folder of the running program, where the other programs of the lab lie too.
std::filesystem::path program_directory();

}  // namespace prehend
