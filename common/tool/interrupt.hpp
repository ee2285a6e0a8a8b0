#pragma once

/// Ctrl-C, a closed terminal and what asks a program politely to end (SIGINT, SIGHUP, SIGTERM), for
/// programs that finish something before they do: whoever has started others stops them first.
namespace prehend::tool {

/// From now on they are only noted.
void note_interrupts();
/// One has come since then. Safe from every thread.
bool interrupted();

}  // namespace prehend::tool
