#pragma once

#include <string>

namespace prehend::performer {

/// What goes on, on standard error: one line that is renewed on a terminal, else a line whenever it
/// says something new.
void show_news(const std::string& line);
/// Takes that line off the terminal.
void end_news();

}  // namespace prehend::performer
